#include "bench/signals.h"

#include <stdio.h>

typedef enum { VALUE, RATE } kind_t;

/* X(name, kind, expression of the bench b and its accounts) */
#define BENCH_SIGNALS(X)                                                                                               \
    X("time_s", VALUE, b->time_s)                                                                                      \
    X("driver.reference_m_per_s", VALUE, b->demand.reference_m_per_s)                                                  \
    X("driver.drive_nm", VALUE, b->demand.drive_nm)                                                                    \
    X("driver.brake_nm", VALUE, b->demand.brake_nm)                                                                    \
    X("vehicle.speed_m_per_s", VALUE, b->vehicle.speed_m_per_s)                                                        \
    X("vehicle.acceleration_m_per_s2", RATE, b->vehicle.speed_m_per_s)                                                 \
    X("vehicle.distance_m", VALUE, b->vehicle.distance_m)                                                              \
    X("vehicle.height_m", VALUE, b->vehicle.height_m)                                                                  \
    X("battery.voltage_v", VALUE, b->battery.terminal_v)                                                               \
    X("battery.current_a", VALUE, b->battery.current_a)                                                                \
    X("battery.soc", VALUE, b->battery.soc)                                                                            \
    X("battery.polarisation_v", VALUE, b->battery.polarisation_v)                                                      \
    X("battery.collapsed", VALUE, b->battery.collapsed ? 1.0 : 0.0)                                                    \
    X("battery.chemical_w", RATE, accounts->run.chemical_j)                                                            \
    X("battery.loss_w", RATE, accounts->run.battery_j)

/* X(name, kind, expression of the wheel w) */
#define WHEEL_SIGNALS(X)                                                                                               \
    X("motor_torque_nm", RATE, w->totals.torque_impulse_nms)                                                           \
    X("hydraulic_torque_nm", RATE, w->totals.hydraulic_impulse_nms)                                                    \
    X("dc_w", RATE, w->totals.dc_j)                                                                                    \
    X("shaft_w", RATE, w->totals.shaft_j)                                                                              \
    X("copper_w", RATE, w->totals.copper_j)                                                                            \
    X("iron_w", RATE, w->totals.iron_j)                                                                                \
    X("inverter_w", RATE, w->totals.conduction_j + w->totals.diode_j + w->totals.switching_j)                          \
    X("phase_a_a", VALUE, plant_inverse_clarke(w->rotor.terminal).a)                                                   \
    X("phase_b_a", VALUE, plant_inverse_clarke(w->rotor.terminal).b)                                                   \
    X("phase_c_a", VALUE, plant_inverse_clarke(w->rotor.terminal).c)                                                   \
    X("current_d_a", VALUE, plant_park(w->rotor.terminal, w->rotor.axis).d)                                            \
    X("current_q_a", VALUE, plant_park(w->rotor.terminal, w->rotor.axis).q)                                            \
    X("theta_turn", VALUE, w->rotor.theta_turn)                                                                        \
    X("winding_temperature_c", VALUE, w->winding.temperature_c)                                                        \
    X("switch_temperature_c", VALUE, w->switches.temperature_c)                                                        \
    X("bridge", VALUE, (double)w->active.bridge)                                                                       \
    X("command_nm", VALUE, 1e-3 * w->slow.motor_torque_command_mNm)                                                    \
    X("estimate_nm", VALUE, 1e-3 * w->slow.motor_torque_estimate_mNm)                                                  \
    X("hydraulic_command_nm", VALUE, 1e-3 * w->slow.hydraulic_torque_mNm)                                              \
    X("available_nm", VALUE, 1e-3 * w->slow.electric_brake_available_mNm)                                              \
    X("speed_estimate_rad_per_s", VALUE, 1e-3 * w->slow.speed_mrad_s)                                                  \
    X("theta_estimate_turn", VALUE, (double)w->to_slow.foc.theta_turn / 65536.0)                                       \
    X("current_d_estimate_a", VALUE, 1e-3 * w->slow.i_d_mA)                                                            \
    X("current_q_estimate_a", VALUE, 1e-3 * w->slow.i_q_mA)                                                            \
    X("voltage_estimate_v", VALUE, 1e-3 * w->slow.bus_voltage_mV)                                                      \
    X("bus_current_estimate_a", VALUE, 1e-3 * w->slow.bus_current_mA)                                                  \
    X("reason", VALUE, (double)w->slow.torque_reason)                                                                  \
    X("available_reason", VALUE, (double)w->slow.available_reason)                                                     \
    X("fault_reason", VALUE, (double)w->slow.fault_reason)                                                             \
    X("first_fault_reason", VALUE, (double)w->first_fault)                                                             \
    X("first_fault_s", VALUE, w->first_fault_s)                                                                        \
    X("mode", VALUE, (double)w->slow.mode)                                                                             \
    X("stop_lamp", VALUE, w->slow.stop_lamp ? 1.0 : 0.0)

typedef struct {
    const char *name;
    kind_t kind;
} line_t;

#define LINE(name, kind, expression) {name, kind},
#define LEDGER_LINE(name, text) {"energy." #name, VALUE},
#define BRAKING_LINE(name, text) {"braking." #name, VALUE},
static const line_t BENCH_LINES[] = {BENCH_SIGNALS(LINE) LEDGER_LIST(LEDGER_LINE) LEDGER_LIST(BRAKING_LINE)};
static const line_t WHEEL_LINES[] = {WHEEL_SIGNALS(LINE)};

enum {
    BENCH_COUNT = sizeof(BENCH_LINES) / sizeof(BENCH_LINES[0]),
    WHEEL_COUNT = sizeof(WHEEL_LINES) / sizeof(WHEEL_LINES[0])
};

int signals_count(const bench_t *bench)
{
    return (int)BENCH_COUNT + bench->wheels * (int)WHEEL_COUNT;
}

static const line_t *line_at(int index)
{
    return index < (int)BENCH_COUNT ? &BENCH_LINES[index] : &WHEEL_LINES[(index - (int)BENCH_COUNT) % (int)WHEEL_COUNT];
}

void signals_name(const bench_t *bench, int index, char *name, size_t size)
{
    (void)bench;
    if (index < (int)BENCH_COUNT) {
        snprintf(name, size, "%s", line_at(index)->name);
    } else {
        snprintf(name, size, "wheel%d.%s", (index - (int)BENCH_COUNT) / (int)WHEEL_COUNT, line_at(index)->name);
    }
}

bool signals_is_rate(const bench_t *bench, int index)
{
    (void)bench;
    return line_at(index)->kind == RATE;
}

#define READ(name, kind, expression) (expression),
#define READ_RUN(name, text) accounts->run.name,
#define READ_BRAKING(name, text) accounts->braking.name,

/* In the order of BENCH_LINES. */
static double read_bench(const bench_t *b, const signals_accounts_t *accounts, int index)
{
    const double values[] = {BENCH_SIGNALS(READ) LEDGER_LIST(READ_RUN) LEDGER_LIST(READ_BRAKING)};
    return values[index];
}

/* In the order of WHEEL_LINES. */
static double read_wheel(const wheel_t *w, int index)
{
    const double values[] = {WHEEL_SIGNALS(READ)};
    return values[index];
}

signals_accounts_t signals_accounts(const bench_t *bench)
{
    const signals_accounts_t out = {.run = bench_ledger(bench), .braking = bench_braking_ledger(bench)};
    return out;
}

double signals_read(const bench_t *bench, const signals_accounts_t *accounts, int index)
{
    if (index < (int)BENCH_COUNT) {
        return read_bench(bench, accounts, index);
    }
    const int beyond = index - (int)BENCH_COUNT;
    return read_wheel(&bench->wheel[beyond / (int)WHEEL_COUNT], beyond % (int)WHEEL_COUNT);
}
