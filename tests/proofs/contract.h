/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contract.h: what the contracts' expressions may use, and the configuration of their proofs: any
 * one whose fields are within the ranges of config.h. The elements of its tables are any values.
 */
#ifndef CONTRACT_H
#define CONTRACT_H

#include "config/config.h"
#include "proof.h"

/* True if a condition holds for i = 0 .. n - 1, and if it does for one of them. */
#define every(i, n, condition)                                                                     \
    ({                                                                                             \
        bool all_of = true;                                                                        \
        for (int i = 0; i < (n); i++) {                                                            \
            all_of = all_of && (condition);                                                        \
        }                                                                                          \
        all_of;                                                                                    \
    })
#define some(i, n, condition) (!every(i, n, !(condition)))

/* The same where it is assumed: the index is one for which it holds, which the checker chooses. */
#define chosen_some(i, n, condition)                                                               \
    ({                                                                                             \
        int i;                                                                                     \
        is_within(i, 0, (n)-1) && (condition);                                                     \
    })

/* A postcondition for all i = 0 .. n - 1. It is proved for one i, which is any; callers may assume
 * it of one i at most. */
#define each(i, n, condition)                                                                      \
    ({                                                                                             \
        const int i = proof_any_index;                                                             \
        !is_within(i, 0, (n)-1) || (condition);                                                    \
    })

extern int proof_any_index;

/* lowest <= x <= highest */
#define is_within(x, lowest, highest) ((x) >= (lowest) && (x) <= (highest))

#define LEAST_OF(a, b, c, d) q_min(q_min(a, b), q_min(c, d))
#define MOST_OF(a, b, c, d) q_max(q_max(a, b), q_max(c, d))

/* In a run that looks for contradicting preconditions: must be refuted. */
#ifdef CONTRACT_ENDS
#define CONTRACT_END(text) __CPROVER_assert(0, text)
#else
#define CONTRACT_END(text) ((void)0)
#endif

extern config_t proof_config;

#define CONTRACT_FIELD(name, lowest, highest, unit, text)                                          \
    ASSUME(is_within(any.name, lowest, highest));
#define CONTRACT_SECTION(section, fields)                                                          \
    {                                                                                              \
        config_##section##_t any;                                                                  \
        fields(CONTRACT_FIELD);                                                                    \
        proof_config.section = any;                                                                \
    }

static inline void any_configuration(void)
{
    CONTRACT_SECTION(motor, CONFIG_MOTOR_FIELDS)
    CONTRACT_SECTION(drive, CONFIG_DRIVE_FIELDS)
    CONTRACT_SECTION(current_loop, CONFIG_CURRENT_LOOP_FIELDS)
    CONTRACT_SECTION(rotor, CONFIG_ROTOR_FIELDS)
    CONTRACT_SECTION(battery, CONFIG_BATTERY_FIELDS)
    CONTRACT_SECTION(brake, CONFIG_BRAKE_FIELDS)
    CONTRACT_SECTION(vehicle, CONFIG_VEHICLE_FIELDS)
    CONTRACT_SECTION(driver, CONFIG_DRIVER_FIELDS)
    CONTRACT_SECTION(pedals, CONFIG_PEDALS_FIELDS)
    CONTRACT_SECTION(service, CONFIG_SERVICE_FIELDS)
    CONTRACT_SECTION(can, CONFIG_CAN_FIELDS)
    CONTRACT_SECTION(tolerance, CONFIG_TOLERANCE_FIELDS)
    CONTRACT_SECTION(modes, CONFIG_MODES_FIELDS)
    CONTRACT_SECTION(monitor, CONFIG_MONITOR_FIELDS)
    CONTRACT_SECTION(thermal, CONFIG_THERMAL_FIELDS)
    CONTRACT_SECTION(regen_map, CONFIG_REGEN_MAP_FIELDS)
    CONTRACT_SECTION(current_map, CONFIG_CURRENT_MAP_FIELDS)
    CONTRACT_SECTION(flux_map, CONFIG_FLUX_MAP_FIELDS)
}

#endif
