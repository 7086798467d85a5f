/*
 * rotor.h: electrical angle and speed of the rotor, once per PWM period, from one of two inputs:
 *   - an absolute electrical angle (encoder, or the ideal angle of a simulation), smoothed by a second-order tracking
 *     loop that has no steady-state error at constant speed;
 *   - three hall sensors (hall.h).
 */
#ifndef FOC_ROTOR_H
#define FOC_ROTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "foc/hall.h"

/* Second-order tracking loop. */
typedef struct {
    uint32_t theta_q32; /* turns */
    int32_t speed_q32;  /* turns per period */
    bool started;
} rotor_pll_t;

typedef struct {
    hall_t hall;
    rotor_pll_t pll;
} rotor_state_t;

typedef struct {
    uint16_t theta_turn;
    int32_t speed_q32;   /* electrical turns per PWM period, forward positive */
    int32_t age_periods; /* since the last hall edge; 0 for an absolute angle */
    bool valid;          /* the angle may be used for torque */
} rotor_out_t;

void rotor_init(rotor_state_t *state, const config_t *config);

/* One period of the tracking loop. */
void rotor_pll_step(rotor_pll_t *pll, const config_t *config, uint16_t angle_turn);

/* angle_turn is read with CONFIG_ROTOR_ANGLE, hall_state (bit 0 A, 1 B, 2 C) with CONFIG_ROTOR_HALL. */
static inline rotor_out_t rotor_step(rotor_state_t *state, const config_t *config, uint16_t angle_turn,
                                     uint8_t hall_state)
{
    rotor_out_t out;
    if (config->rotor.sensor == CONFIG_ROTOR_HALL) {
        hall_step(&state->hall, config, hall_state);
        out.theta_turn = (uint16_t)(state->hall.theta_q32 >> 16);
        out.speed_q32 = state->hall.speed_q32;
        out.age_periods = state->hall.periods_since_edge;
        out.valid = state->hall.valid;
    } else {
        rotor_pll_step(&state->pll, config, angle_turn);
        out.theta_turn = (uint16_t)(state->pll.theta_q32 >> 16);
        out.speed_q32 = state->pll.speed_q32;
        out.age_periods = 0;
        out.valid = true;
    }
    return out;
}

#endif
