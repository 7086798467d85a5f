/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor.h: independent monitoring. It checks measurements and steps with its own arithmetic and
 * bounds, names a fault or warning, and selects the bridge's safe state. It never computes torque.
 *
 * Fast part (every PWM period): length of the current vector, bus over-voltage, the power stage's
 * fault line. A trip is latched, and the bridge goes to the safe state in the same period,
 * independently of the slow loop. Slow part (1 kHz): sum of currents, saturated sensors, bus
 * voltage, temperatures, rotor, its angle against the back-EMF (monitor_emf.h), torque against the
 * command, program flow (each loop counts the other's steps), and the upper bound of the wheel
 * speed (monitor_speed.h), which decides between freewheel and active short circuit.
 */
#ifndef MONITOR_MONITOR_H
#define MONITOR_MONITOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/frames.h"
#include "core/reason.h"
#include "monitor/monitor_bus.h"
#include "monitor/monitor_current.h"
#include "monitor/monitor_emf.h"
#include "monitor/monitor_gain.h"
#include "monitor/monitor_open.h"
#include "monitor/monitor_speed.h"
#include "monitor/monitor_stuck.h"
#include "monitor/safe_state.h"

enum {
    /* Milliseconds without a slow step after which the fast loop trips. */
    MONITOR_STALE_STEPS = 4,
    /* Milliseconds without torque after a bus has come back from beyond a trip, or its contactor
     * has closed: one that bounces does not take the hydraulic torque back with every contact. */
    MONITOR_BUS_RETURN_STEPS = 100,
    /* Weights of a slow step with a wrong number of fast steps and of one with the right number,
     * and their sum that is a fault: three wrong ones in a row, or five of nine; two in a row with
     * twice the number, before halls contradict an angle that runs ahead. */
    MONITOR_FLOW_WRONG = 2,
    MONITOR_FLOW_TWICE = 3,
    MONITOR_FLOW_RIGHT = -1,
    MONITOR_FLOW_FAULT = 6,
    /* Milliseconds that an open bridge waits for PWM before a short circuit that surges. */
    MONITOR_SHORT_WAIT_STEPS = 150,
    /* Square of the current that a dead sensor may show, Q30: six codes of a 12-bit converter. */
    MONITOR_DEAD_SQUARE = 96 * 96,
    /* More than a bus rises in one period, Q15 of the voltage base: 5/64, of a capacitor that is
     * charged from half of the range to all of it in six periods; less of a larger one that the
     * configuration gives (monitor_fast_init()), at least 1/64. */
    MONITOR_BUS_JUMP_PU = 2560,
    MONITOR_BUS_LEAST_JUMP_PU = 512,
    /* Less than what drives a current through a motor, so no motor empties a bus so far: 1/64. */
    MONITOR_BUS_EMPTY_SHARE = 64,
    /* A temperature limit of this value is switched off, for example if there is no sensor. */
    MONITOR_TEMPERATURE_OFF_cC = 30000
};

/* ---- fast ---- */

typedef struct {
    /* Computed once from the configuration. */
    uint32_t overcurrent_square; /* Q30 of the current base */
    int32_t overvoltage_pu;      /* Q15 of the voltage base */
    int32_t jump_pu;             /* largest rise of a bus in a period, likewise */
    int32_t stale_limit_periods; /* PWM periods without a slow step */
    int32_t trip_periods;        /* qualify time of an over-current */
    int32_t dead_periods;        /* qualify time of a current that has vanished */
    /* State. */
    reason_t trip;
    uint32_t inverted_trip; /* ~trip: a bit that flips in RAM is found (monitor_fast_intact()) */
    int32_t
        current_periods;  /* above the trip; negative: at zero since the latest one that was not */
    int32_t periods_left; /* left until PROGRAM_FLOW without a slow step */
    int32_t last_v_dc_pu; /* of the period before */
    uint16_t last_slow_step;
} monitor_fast_state_t;

typedef struct {
    dq16_t i_pu;     /* Q15 of the current base, components saturated */
    int32_t v_dc_pu; /* Q15 of the voltage base */
    bool power_stage_fault;
    bool switching;  /* PWM: slow steps must come, and no current may exceed its limit */
    bool clear_trip; /* the fault has been acknowledged */
    uint16_t slow_step_count;
    uint32_t least_square; /* Q30, of the current vector at the present setpoint; below the trip */
} monitor_fast_input_t;

void monitor_fast_init(monitor_fast_state_t *state, const config_t *config);

/* Background: false if the trip differs from its inverted copy, or a limit from what the
 * configuration makes it. A trip that comes in the middle of the comparison may look like damage:
 * two calls in a row decide. */
bool monitor_fast_intact(const monitor_fast_state_t *state, const config_t *config);

/* monitor_fast_step() is in monitor_fast.h. */

/* ---- slow ---- */

typedef struct {
    uint16_t bus_steps; /* beyond a trip and not back */
    uint16_t sum_steps, sensor_steps, rotor_steps, torque_steps, temperature_steps;
    uint16_t flow_level; /* weighted sum of wrong and right steps */
    uint16_t last_fast_step;
    uint16_t last_rotor_faults;
    uint16_t warning_steps; /* left of the warning's heal time */
    uint16_t steps;         /* step count, wrapping: the watchdog is fed only while it advances */
    bool release_trip;      /* the bus is back from above its trip */
    uint16_t return_steps;  /* left until torque returns after that */
    uint16_t open_steps;    /* likewise, after a contactor reported open */
    uint16_t short_steps;   /* for which a short circuit would have surged */
    bridge_mode_t safe_bridge;
    monitor_emf_state_t emf;
    monitor_current_state_t current;
    monitor_speed_state_t speed;
    monitor_stuck_state_t stuck;
    monitor_open_state_t open;
    monitor_window_t bus;
    monitor_window_t gain;
    bool bus_was_low;      /* of the latest bus beyond a trip */
    bool bus_sensor_wrong; /* its reading went where no bus goes */
    bool started;
    monitor_swing_state_t swing;
} monitor_slow_state_t;

typedef struct {
    reason_t fast_trip;
    int32_t current_sum_pu; /* Q15 */
    /* The offsets are calibrated; the sum of currents is checked from then on. */
    bool offsets_known;
    bool current_saturated;
    uint8_t wrong_current_sensor; /* named by the fast loop: 1 .. 3, phase a, b, c; 0: none */
    bool current_undetermined;    /* the sum is implausible and no single sensor explains it */
    bool rotor_valid;
    uint16_t rotor_faults;
    uint16_t fast_step_count;
    int32_t bus_voltage_mV;
    bool battery_open;          /* reported: the contactor is open */
    int32_t battery_voltage_mV; /* reported; 0: not given */
    int32_t battery_current_mA; /* reported, of all wheels; MONITOR_GAIN_NOT_GIVEN */
    int32_t bus_current_mA;     /* of this wheel by the current loop */
    int32_t charge_current_mA;  /* that the battery takes from this wheel */
    int32_t speed_mrad_s;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    bool winding_sensor_broken, switch_sensor_broken; /* the temperature is an estimate */
    int32_t i_d_mA, i_q_mA;      /* of the latest period, peak phase, estimated frame */
    bool frame_known;            /* that frame is the rotor's: of a sensor that is right */
    int32_t u_d_mV, u_q_mV;      /* likewise, as applied */
    bool voltage_limited;        /* likewise */
    dq_t sampled_pu;             /* mean of the sampled currents over the last millisecond, Q15 */
    dq_t reference_pu;           /* of that millisecond, Q15 */
    dq_t latest_pu;              /* sampled in the latest period, Q15 */
    uint16_t theta_turn;         /* electrical angle used in that period */
    int32_t torque_command_mNm;  /* of the last step, signed */
    int32_t torque_estimate_mNm; /* signed */
    int32_t offset_q4[3];        /* zero-current codes * 16 */
    uint16_t current_quarters;   /* quadrant transitions of the current vector while not switching,
                                    wrapping */
    uint16_t quarter_step;       /* fast_step_count at the latest of them */
    uint32_t idle_alpha_pu, idle_beta_pu; /* running sums of the current while not switching */
    bridge_mode_t bridge;                 /* actual mode */
} monitor_slow_input_t;

typedef struct {
    reason_t fault;           /* REASON_NONE, or the reason to remove the torque enable */
    reason_t warning;         /* REASON_NONE, or the reason for reduced driving torque (LIMP) */
    reason_t flux_warning;    /* of the lowest priority: what the back-EMF says of flux and bus */
    int32_t flux_missing_q15; /* share of the flux that makes no torque, 0 .. 16 384: FLUX_WEAK, by
                                 a bus voltage that the battery's message confirms */
    bridge_mode_t safe_bridge;
    bool emf_conducts;       /* the EMF drives a current in the safe state: no zero to be seen */
    int32_t charging_mA;     /* into the bus, in the safe state */
    int32_t emf_mV;          /* w psi at the speed upper bound, peak phase */
    int32_t safe_torque_mNm; /* braking torque of the safe state, magnitude */
    bool battery_lost;       /* no torque: the battery is disconnected, or the bus beyond a trip */
    bool release_trip;       /* the bus is back: the fast loop forgets its over-voltage trip */
    bool release_break;      /* a stuck switch calls for a short circuit: the bridge may leave the
                                hardware's latch, but not its trip */
    bool offsets_plausible;
    bool standstill; /* the speed upper bound is below monitor.standstill */
    bool at_rest;    /* likewise, and no sensor has shown it by stopping (monitor_speed.h) */
    int32_t speed_bound_mrad_s; /* the speed upper bound, mechanical, magnitude */
} monitor_output_t;

void monitor_slow_init(monitor_slow_state_t *state);

/* 1 kHz. The invariant monitor_state_holds() is in tests/proofs/invariants.h. */
monitor_output_t monitor_slow_step(monitor_slow_state_t *state, const config_t *config,
                                   const monitor_slow_input_t *in);

/* Braking torque that the voltage may force at a speed whatever is commanded: 0 or
 * motor.max_torque. README, Natural torque. */
int32_t monitor_forced_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                                  int32_t bus_voltage_mV);

#endif
