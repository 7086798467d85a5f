/* SPDX-License-Identifier: Apache-2.0 */
/*
 * state.h: the state of one wheel's fast loop. Complete only so that a caller can own one; no code
 * outside firmware/foc reads or writes a member. The header of the module named at each structure
 * explains the fields' use.
 */
#ifndef FOC_STATE_H
#define FOC_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/circle.h"
#include "core/fast_messages.h"
#include "core/frames.h"

enum { FOC_NO_SETPOINT = -1 /* no sequence number: the next setpoint is applied */ };

/* sense.h */
typedef struct {
    int32_t offset_q4[SENSE_PHASES]; /* zero-current code * 16 */
    uint32_t sum[SENSE_PHASES];
    uint16_t samples; /* of the calibration in progress */
    bool calibrated;
} sense_state_t;

/* hall.h. Angles in turns; periods are PWM periods. */
typedef struct {
    union { /* what an edge copies; as words the processor copies four at once */
        struct {
            int32_t speed_q32; /* turns per period, forward positive */
            uint32_t theta_q32;
            int32_t periods_since_edge;   /* 0 .. 65 535 */
            int32_t overdue_periods;      /* periods_since_edge beyond which the speed decays */
            uint32_t begin_q32, span_q32; /* where the angle stays: in the sector, or its half */
            int32_t bounce_periods; /* a reversal within these is a bounce; 0: speed unknown */
            uint32_t timed_turn;    /* sums over the sectors timed in this movement, <= 6 */
            uint32_t timed_periods;
            uint32_t edge_theta_q32;    /* at the last plausible edge */
            int32_t edge_speed_q32;     /* from there on */
            uint32_t observer_lead_q32; /* of the observed angle over the sensors', learned */
            uint16_t faults;            /* wrapping */
            uint8_t sectors_timed;      /* 0 .. 6 */
            int8_t direction;           /* of the last edge: +1, -1; 0 unknown */
            uint8_t plausible_edges;    /* since the latest hall fault */
            uint8_t sector;             /* 0 .. 5 */
            bool valid;                 /* false once started: hall fault ride-through */
            bool started;
        };
        struct {
            uint32_t word[14];
        } movement;
    };
    uint16_t sector_periods[CONFIG_HALL_EDGES]; /* latest full crossing of each sector */
    int32_t standstill_periods;                 /* 1/4 s */
    int32_t reversal_periods;                   /* 15 ms */
    int32_t invalid_periods;                    /* consecutive, in an impossible state */
    uint8_t steady_sensors; /* unchanged reading that is skipped; HALL_NO_READING: none */
} hall_t;

/* angle_tracker.h */
typedef struct {
    uint32_t theta_q32; /* turns */
    int32_t speed_q32;  /* turns per period */
    bool started;
} angle_tracker_t;

/* absolute_angle.h */
typedef struct {
    angle_tracker_t tracker;
    uint16_t faults; /* wrapping */
    uint8_t settled; /* consecutive samples near their prediction, 0 .. 255 */
    uint8_t apart;   /* samples far from it less others, 0 .. 95 */
    bool valid;
} absolute_angle_t;

/* encoder.h */
typedef struct {
    /* From the configuration. */
    uint32_t turn_per_count_q32; /* electrical */
    uint32_t origin_q32;         /* angle of count 0 after the index, middle of the count */
    int32_t counts;              /* in a mechanical turn */
    int32_t tolerance_counts;
    int32_t overdue_counts; /* distance from the last index at which the next one is missing */
    int32_t max_counts;     /* in one period */
    int32_t count_turn;     /* electrical angle of one count */
    int32_t sign;           /* of a count when turning forward */
    /* State. */
    angle_tracker_t tracker;
    uint16_t theta_turn;
    uint32_t base_q32; /* angle of position 0: origin_q32, or the predicted angle after a jump */
    int32_t position_counts; /* forward from the last index; arbitrary origin before the first */
    uint16_t last_count;
    uint16_t faults; /* wrapping */
    bool started;
    bool referenced; /* an index was seen */
    bool valid;
} encoder_t;

/* emf_observer.h: gains of the tracking loop, turns Q32 per error Q15 */
typedef struct {
    int32_t proportional, integral;
} observer_gains_t;

/* emf_observer.h: shares of the flux full scale; of constant pairs both components are equal */
typedef struct {
    uint32_t theta_q32;          /* of x at the next sample, turns */
    int32_t speed_q32;           /* turns per period */
    int32_t start_speed_q32;     /* when the bridge last stopped to switch */
    int32_t alpha_q30, beta_q30; /* integrated voltage less R i, with its leak */
    observer_gains_t gains;      /* in use */
    ab16_t x;                    /* active flux, Q14 */
    uint32_t periods;            /* of the acquisition, since its beginning */
    observer_gains_t acquisition, tracking;
    uint32_t acquisition_periods;
} emf_observer_t;

/* rotor.h */
typedef struct {
    hall_t hall;
    hall_t before_edge; /* hall, before the edge of the last period; not valid: there was none */
    encoder_t encoder;
    absolute_angle_t absolute;
    int32_t sensor; /* config.rotor.sensor */
} rotor_state_t;

/* sensor_isolation.h: periods in which the named sensor agrees with the other two */
typedef struct {
    int32_t periods; /* up to as many as are enough */
    int32_t turned;  /* electrical angle in them, up to a turn either way */
} agreement_t;

/* sensor_isolation.h */
typedef struct {
    int32_t suspect_pu; /* |sum| that is examined; beyond every sum while a sensor is named */
    uint32_t suspect_range_pu; /* twice that; 0 while a sensor is named, which examines every sum */
    int32_t implausible_pu;    /* |sum| that no healthy sensors make */
    int32_t removed_share_q15; /* of a current error by one period's voltage, a (1 - a) */
    int32_t l_q_over_l_d_q10, l_d_over_l_q_q10;
    dq_t predicted_pu;    /* for the latest examined sample */
    dq_t change_pu;       /* from that to the next sample */
    int32_t begin_sum_pu; /* the sum when the prediction began */
    uint32_t last_step;   /* step_count of the latest examined sample */
    uint16_t periods;     /* since the prediction began; 0: none */
    uint16_t agreeing;    /* consecutive implausible sums with the same answer */
    uint16_t unknown;     /* consecutive implausible sums without, wrapping */
    uint8_t answer;       /* the latest: phase, or SENSE_PHASES */
    uint8_t phase;        /* whose sensor is named, reconstructed; SENSE_PHASES: none */
    bool undetermined;    /* an implausible sum that no single sensor explains */
    /* Of the named sensor. */
    bool may_return;        /* its return counts: it was wrong for no longer than a glitch */
    uint8_t signs;          /* of the current in `proved`: 1 negative, 2 positive, 3 both */
    uint16_t theta_turn;    /* at the latest sample */
    uint32_t named_step;    /* step_count when it was named */
    uint32_t used_step;     /* step_count when a sensor was last used again */
    agreement_t returned;   /* since they have disagreed last */
    agreement_t proved;     /* of these, with much current in its phase */
    int32_t agrees_periods; /* are enough to have returned: 20 ms */
    int32_t proof_periods;  /* are enough to be used again: as many, or more after each return */
} sensor_isolation_t;

/* frozen_currents.h */
typedef struct {
    uint32_t begin_step; /* step_count at the look from which on they have not moved */
    uint32_t last_step;  /* at the latest look */
    uint16_t code[SENSE_PHASES];
} frozen_currents_t;

/* current_controller.h */
typedef struct {
    int32_t integrator_q30; /* voltage, |.| < 1 */
} pi_state_t;

/* current_controller.h */
typedef struct {
    pi_state_t d, q;
} current_controller_t;

/* current_controller.h: the tuning as the controller reads it */
typedef struct {
    q_pair_t d_gain_q10;      /* (k_p, -w L_q) of the d axis */
    q_pair_t q_gain_q10;      /* (w L_d, k_p) of the q axis */
    q_pair_t integral_q15;    /* (d, q) */
    q_pair_t anti_windup_q15; /* (d, q) */
    int32_t forward_d_q25, forward_q_q25;
} current_gains_t;

/* reference_prefilter.h: r'[n] = b0 r[n] + b1 r[n-1] + b2 r[n-2], b0 + b1 + b2 = 1 */
typedef struct {
    int32_t one_minus_b0_q15; /* 0.07 .. 0.5 */
    int32_t minus_b2_q15;     /* 0 .. 0.29 */
    dq_t reference_pu;        /* r[n], inside the current circle */
    dq_t change_pu;           /* r[n] - r[n-1]; changes below the threshold count as zero */
    bool settled;             /* the output equals the reference */
} reference_prefilter_t;

/* current_predictor.h */
typedef struct {
    int32_t lag_q16;           /* 1 - a, 1/16 .. 0.4 */
    int32_t first_q15;         /* (1 - b)/2: share of a change in its first period */
    int32_t second_q15;        /* b (1 - b)/2: remainder in its second period beyond the share a */
    int32_t weight_q15;        /* m, 0 .. 0.52 */
    int32_t target_first_q15;  /* distance of the target in the first period, 0.78 .. 0.84 */
    int32_t target_second_q15; /* in the second period, 0.27 .. 0.34 */
    dq16_t settled_pu;         /* the current once every change has settled */
    dq16_t predicted_pu;       /* for the present period */
} current_predictor_t;

/* field_weakening.h */
typedef struct {
    int32_t current_q28;       /* -limit .. 0 */
    int32_t target_square_q15; /* of the modulation index; constant */
} field_weakening_t;

/* modulation.h: constants */
typedef struct {
    int32_t centre_q16;          /* half the period and half a count for rounding */
    int32_t trim_doubled_counts; /* twice the full dead-time correction, 0 .. 4096 */
    int32_t alpha_counts;        /* sqrt(3) * limit * period: of one modulation unit */
    int32_t beta_counts;         /* limit * period */
    int32_t limit_q15;           /* radius of the voltage circle, share of u_dc/sqrt 3 */
} modulation_t;

/* The current loop, in the order that costs the fewest instructions on all cores. */
typedef struct {
    current_gains_t gains; /* of the setpoint in use, delay compensated */
    current_controller_t controller;
    dead_time_slope_t slope; /* of the setpoint in use */
    rotation_t advance;      /* of the setpoint in use */
    modulation_t modulation;
    current_predictor_t predictor;
    sensor_isolation_t isolation;
    sense_state_t sense;
    int32_t on_q16[SENSE_PHASES]; /* high-side on-times, timer counts; effective from the next
                                     update */
    frozen_currents_t frozen;
} foc_current_state_t;

/* Rotor estimate at the sample. */
typedef struct {
    uint16_t theta_turn; /* electrical, 65 536 = one turn */
    int32_t speed_q32;   /* electrical turns per PWM period, forward positive */
    uint16_t faults;     /* wrapping count of readings that a healthy sensor cannot give */
    bool valid;          /* the angle may be used for torque; the speed is that of the angle */
} rotor_out_t;

/* Voltage of one period in modulation units. */
typedef struct {
    int32_t unsaturated_d_q25, unsaturated_q_q25; /* before the voltage circle, |.| < 50 */
    dq16_t applied;                               /* Q15, inside the unit circle */
} voltage_out_t;

/* idle_currents.h */
typedef struct {
    uint32_t quadrant;             /* of the current vector, 0 .. 3 */
    uint16_t quadrant_transitions; /* wrapping; forward counts up */
    uint16_t quadrant_step;        /* step_count at the latest of them */
    uint32_t alpha_pu, beta_pu;    /* sums of the current, wrapping */
} idle_currents_t;

/* One period: what was measured and what was done. */
typedef struct {
    rotor_out_t rotor;      /* by the sensor */
    uint16_t theta_turn;    /* electrical angle that the current controller uses */
    ab16_t i_ab_pu;         /* sampled current, stator frame */
    dq16_t i_reference_pu;  /* prefiltered, inside the current circle */
    dq16_t i_pu;            /* sampled current, Q15 of the current base; components saturate at 1 */
    voltage_out_t voltage;  /* acts in the next period */
    ab16_t u_ab;            /* the same in the stator frame; components saturate at 1 */
    int32_t current_sum_pu; /* of the three readings */
    int32_t v_dc_pu;        /* Q15 of the voltage base */
    uint32_t step_count;    /* number of the period since the start, wrapping */
} foc_period_t;

typedef struct {
    foc_period_t period; /* the latest */
    foc_current_state_t current;
    rotor_state_t rotor;
    ab16_t u_acting; /* u_ab of the period before: acts from this sample to the next */
    emf_observer_t observer;
    circle_t current_circle;
    reference_prefilter_t prefilter;
    field_weakening_t weakening;
    foc_sums_t sums;
    uint32_t spare_step; /* step_count at which the spare tasks are due */
    int32_t sequence;    /* of the setpoint in use, or FOC_NO_SETPOINT */
    idle_currents_t idle;
    bool calibrating; /* of the current sensors, in the latest period with the bridge off */
    bool postponed; /* a new setpoint has waited for a hall edge; true at a start, which never waits
                     */
} foc_state_t;

#endif
