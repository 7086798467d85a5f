/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor.h: the independent watcher. It looks at what the others do with its own eyes and its own
 * arithmetic, names what is wrong, and says what the bridge should do then. It never computes
 * torque.
 *
 * Fast part (every PWM period): length of the current vector, bus over-voltage, the power stage's
 * own fault line. A trip is latched, and the bridge goes to the safe state in the same period,
 * whatever the slow loop says. Slow part (1 kHz): sum of currents, saturated sensors, bus voltage,
 * temperatures, rotor, its angle against the back-EMF (monitor_emf.h), torque against what was
 * permitted, program flow (each loop counts the other's steps), and how fast the wheel may be
 * turning (monitor_speed.h), which decides what is safe.
 */
#ifndef MONITOR_MONITOR_H
#define MONITOR_MONITOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/reason.h"
#include "core/torque_enable.h"
#include "monitor/monitor_emf.h"
#include "monitor/monitor_speed.h"

enum {
    MONITOR_CONFIRM_STEPS = 20, /* ms a slow condition must hold before it counts */
    MONITOR_ROTOR_STEPS =
        250, /* ms that an angle which is not valid may heal, once the torque has left */
    MONITOR_TRIP_PERIODS = 2, /* PWM periods an over-current must hold: one sample may be a spike */
    MONITOR_DOUBT_STEPS = 10000, /* ms a doubt about the rotor sensor keeps the warning up */
    MONITOR_STALE_STEPS = 4,     /* slow steps that may be missing before the fast loop acts */
    MONITOR_OVERTEMPERATURE_cC = 1000, /* above the temperature at which no torque is left */
    MONITOR_HOTTEST_cC = 29000, /* what lies beyond these two no winding and no switch can be: the
                                   sensor's line is open */
    MONITOR_COLDEST_cC = -6000, /* or shorted (hal/analog.h reports 29999 for either), or a number
                                   has been invented */
    MONITOR_TEMPERATURE_OFF_cC =
        30000 /* a limit of the configuration that is none: there may be no sensor */
};

/* ---- fast ---- */

typedef struct {
    /* Worked out once from the configuration. */
    uint32_t overcurrent_square; /* Q30 of the current base */
    int32_t overvoltage_pu;      /* Q15 of the voltage base */
    int32_t stale_limit_periods; /* PWM periods without a slow step */
    /* State. */
    reason_t trip;
    int32_t overcurrent_periods;
    int32_t patience_periods; /* until the slow loop must have stepped */
    uint16_t last_slow_step;
} monitor_fast_state_t;

typedef struct {
    bridge_mode_t
        safe_bridge; /* the choice of monitor_safe_bridge() for the present speed and voltage */
    bool clear_trip; /* the fault has been acknowledged */
} monitor_command_t;

typedef struct {
    dq_t i_pu;       /* Q15 of the current base */
    int32_t v_dc_pu; /* Q15 of the voltage base */
    bool power_stage_fault;
    bool switching; /* the bridge is in PWM mode */
    uint16_t slow_step_count;
} monitor_fast_input_t;

typedef struct {
    reason_t trip; /* latched, REASON_NONE when healthy */
} monitor_fast_report_t;

void monitor_fast_init(monitor_fast_state_t *state, const config_t *config);

/* monitor_fast_step() is in monitor_fast.h. */

/* ---- slow ---- */

typedef struct {
    uint16_t sum_steps, sensor_steps, rotor_steps, torque_steps, flow_steps, voltage_steps,
        temperature_steps;
    uint16_t last_fast_step;
    uint16_t last_rotor_faults;
    uint16_t doubt_steps; /* left of the warning */
    uint16_t verdicts;    /* counts the steps, wrapping: the watchdog is fed only while it moves */
    bridge_mode_t safe_bridge;
    monitor_emf_state_t emf;
    monitor_speed_state_t speed;
    bool started;
} monitor_slow_state_t;

typedef struct {
    reason_t fast_trip;
    int32_t current_sum_pu; /* Q15 */
    bool offsets_known;     /* the sensors' zeros are calibrated; before, their sum says nothing */
    bool current_saturated;
    bool rotor_valid;
    uint16_t rotor_faults;
    uint16_t fast_step_count;
    int32_t bus_voltage_mV;
    int32_t speed_mrad_s;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    int32_t i_d_mA, i_q_mA;      /* of the latest period, peak phase, estimated frame */
    int32_t u_d_mV, u_q_mV;      /* likewise, as realised */
    bool voltage_limited;        /* likewise */
    int32_t torque_command_mNm;  /* of the last step, signed */
    int32_t torque_estimate_mNm; /* signed */
    int32_t offset_q4[3];        /* zero-current codes * 16 */
    uint16_t
        current_quarters;  /* quarter turns of the current's vector while not switching, wrapping */
    uint16_t quarter_step; /* fast_step_count at the latest of them */
    bridge_mode_t bridge;  /* what it did since the last step */
    bool switching;        /* it was permitted to */
} monitor_slow_input_t;

typedef struct {
    reason_t fault;   /* REASON_NONE, or what must close the valve */
    reason_t warning; /* REASON_NONE, or what calls for reduced driving torque */
    bridge_mode_t safe_bridge;
    bool offsets_plausible;
    bool standstill; /* no sign of a wheel that turns, and none unexplained of one that did
                      (monitor_speed.h) */
} monitor_output_t;

void monitor_slow_init(monitor_slow_state_t *state);

monitor_output_t monitor_slow_step(monitor_slow_state_t *state, const config_t *config,
                                   const monitor_slow_input_t *in);

/*
 * What the bridge should do when it may not switch. Off is harmless while the rectified back-EMF
 * stays below the bus, sqrt(3) psi w_e < v_dc; above, the diodes would charge the bus uncontrolled,
 * and the low-side short keeps the energy in the motor. `now` gives the hysteresis: a short is left
 * only 10 % below the limit. speed_mrad_s: what no wheel turns faster than, monitor_speed_step().
 */
bridge_mode_t monitor_safe_bridge(const config_t *config, int32_t speed_mrad_s,
                                  int32_t bus_voltage_mV, bridge_mode_t now);

#endif
