/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/angle_choice.h"

#include "config/bases.h"
#include "core/q15.h"
#include "motor/observer_error.h"

/* Geometry: the observer's error is below 10 degrees, a hall sensor's below 5. To angles that make
 * a sensor wrong comes what L_q may turn the observer by at the present current. */
enum {
    OPPOSED_TURN = 10923,  /* 60 degrees */
    STANDING_TURN = 16384, /* 90 degrees: a sector that halls do not see, and the observer's 30 */
    SLIPPED_TURN = 2913,   /* 16 degrees */
    ASKEW_TURN = 5461,     /* 30 degrees */
    LATE_TURN = 8374,      /* 46 degrees: 16 and halls that are 30 late */
    AGREED_TURN = 2185,    /* 12 degrees */
    LATE_mrad_s = 45000,   /* electrical, of halls: in a sector a stop turns them by 16 degrees */
    OPPOSED_STEPS = 2,
    OPPOSED_SLOW_STEPS = 12,  /* below the observer's speed */
    LACKING_STEPS = 5,        /* without its flux */
    REST_STEPS = 50,          /* until a sensor did not just stop, or begin, to count */
    OPPOSED_REST_STEPS = 100, /* against a sensor that shows a rotor near rest */
    OPPOSED_SPEEDS = 2,       /* the observer's least speed, from where it is right in 2 ms */
    SLIPPED_SPEEDS = 4,       /* likewise, within 14 degrees whatever dead time there is */
    LEAST_PU = 2048,          /* a sixteenth of the current's full scale */
    CURRENT_STEPS = 40,       /* with it, until the observer has forgotten its dead time */
    NAME_STEPS = 10,          /* until a sensor's speed has followed its angle */
    SLIPPED_STEPS = 12,
    SALIENT_PERMILLE = 1500,
    CONFIRM_STEPS = 2,
    LOSE_STEPS = 2,
    STEADY_STEPS = 11 /* in one direction, but for a start */
};

static uint8_t counted(uint8_t steps, bool condition)
{
    return condition ? (uint8_t)q_min(steps + 1, UINT8_MAX) : (uint8_t)0;
}

/* Does the sensor show a rotor that turns, at half of the observer's speed? */
static bool shows_turning(const config_t *config, const rotor_view_t *in)
{
    return q_abs(in->sensor_mrad_s / 2) >= config->rotor.observer_speed_mrad_s / 4;
}

/* Torque is permitted down to 15/16 of the speed from which it is. */
static bool fast_enough(const angle_choice_state_t *state, const config_t *config,
                        int32_t speed_mrad_s)
{
    const int32_t from_mrad_s = config->rotor.observer_speed_mrad_s;
    return q_abs(speed_mrad_s) >= (state->confirmed ? from_mrad_s - from_mrad_s / 16 : from_mrad_s);
}

/* No rotor near standstill, as the sensor has it, changes its speed by a quarter of the observer's
 * least in a millisecond; an observer that is not settled does, as after the first hall edge, which
 * turns the current by 60 degrees. */
static bool settled(const angle_choice_state_t *state, const config_t *config,
                    const rotor_view_t *in)
{
    const int32_t half_change_mrad_s = in->observer_mrad_s / 2 - state->last_mrad_s / 2;
    return shows_turning(config, in) ||
           q_abs(half_change_mrad_s) <= config->rotor.observer_speed_mrad_s / 8;
}

/* A rotor that turns round passes through standstill, where it cannot be observed: a direction that
 * changes is the observer's, from currents and dead time at low speed, unless it lasts. */
static void watch_direction(angle_choice_state_t *state, const rotor_view_t *in)
{
    const int32_t direction = in->observer_mrad_s >= 0 ? 1 : -1;
    if (!in->switching || !in->acquired || state->against + 1 >= STEADY_STEPS) {
        state->direction = 0;
    }
    const bool same = state->direction == 0 || state->direction == direction;
    state->against = (uint8_t)(same ? 0 : state->against + 1);
    state->direction = (int8_t)(same ? direction : state->direction);
}

/* L i, of the magnets' flux. */
static int32_t linked_permille(const config_t *config, int32_t inductance_nH, int32_t current_pu)
{
    const int64_t linked_pWb = (int64_t)inductance_nH * bases_current_mA(config, current_pu);
    return q_saturate16(q_saturate64(linked_pWb / q_divisor(config->motor.flux_linkage_nWb)));
}

/* The active flux psi - (L_q - L_d) i_d, of the magnets'. Divides. */
static int32_t active_permille(const config_t *config, int32_t i_d_pu)
{
    const config_motor_t *motor = &config->motor;
    return 1000 - linked_permille(config, motor->q_inductance_nH - motor->d_inductance_nH, i_d_pu);
}

/* Half a turn from the rotor the current of a salient motor turns the active flux round, so that
 * the observer, which follows it, agrees with the wrong angle. But there is little of it left: less
 * than the magnets' alone, to which a current adds half at least, and a third of both. */
static bool lacks_flux(const config_t *config, const rotor_view_t *in)
{
    if (in->flux_q14 >= in->expected_q14) {
        return false;
    }
    const int32_t active = active_permille(config, in->i_pu.d);
    return active >= SALIENT_PERMILLE && in->flux_q14 * 3000 < active * in->expected_q14;
}

static void confirm(angle_choice_state_t *state, const config_t *config, const rotor_view_t *in)
{
    watch_direction(state, in);
    state->lacks_flux = in->acquired && lacks_flux(config, in);
    const bool plausible =
        in->switching && in->acquired && in->flux_q14 >= 4 * q_abs(in->across_q14) &&
        in->flux_q14 >= in->expected_q14 / 2 && in->flux_q14 / 4 <= in->expected_q14 &&
        (state->confirmed || settled(state, config, in)) && !state->lacks_flux;
    state->last_mrad_s = in->observer_mrad_s;
    state->plausible = counted(state->plausible, plausible);
    state->implausible = counted(state->implausible, !plausible);
    const bool consistent =
        state->against == 0 &&
        (state->confirmed ? state->implausible < LOSE_STEPS : state->plausible >= CONFIRM_STEPS);
    state->confirmed =
        in->switching && consistent && fast_enough(state, config, in->observer_mrad_s);
}

/* From half its speed on the observer's angle is good enough to take torque away. No step without
 * PWM is plausible. */
static bool watches(const angle_choice_state_t *state, const config_t *config,
                    const rotor_view_t *in)
{
    return state->confirmed ||
           (state->plausible >= CONFIRM_STEPS && state->against == 0 &&
            q_abs(in->observer_mrad_s) >= config->rotor.observer_speed_mrad_s / 2);
}

/* Is the EMF so many times what is not known of the voltage? */
static bool emf_exceeds(const config_t *config, const rotor_view_t *in, int32_t times)
{
    return q_abs(in->observer_mrad_s) / times >= config->rotor.observer_speed_mrad_s;
}

/* Are sensor and observer further apart than an angle and what L_q may make of it? */
static bool apart(const config_t *config, const rotor_view_t *in, int32_t turn)
{
    const int32_t beyond_turn = q_abs(in->difference_turn) - turn;
    if (beyond_turn < 0) {
        return false;
    }
    const motor_current_t i = {.d_mA = bases_current_mA(config, in->i_pu.d),
                               .q_mA = bases_current_mA(config, in->i_pu.q)};
    return !observer_error_explains(config, i, beyond_turn);
}

/* The angle tells a slip where the sensor turns as fast as the observer. Halls do not while they
 * know of an acceleration at their next edge only; halls that stand are 60 degrees off soon. Below
 * its speed an observer does not for a moment where the current changes, and with little current is
 * 35 degrees wrong; halls are half a sector late there, and wherever a sector takes 23 ms. */
static bool slips(const angle_choice_state_t *state, const config_t *config, const rotor_view_t *in)
{
    const bool hall = config->rotor.sensor == CONFIG_ROTOR_HALL;
    const int32_t size_mrad_s = q_abs(in->observer_mrad_s);
    const bool as_fast = q_abs(size_mrad_s - q_abs(in->sensor_mrad_s)) <= size_mrad_s / 4;
    const int32_t slow_turn = hall ? OPPOSED_TURN : ASKEW_TURN;
    const bool late = hall && size_mrad_s < LATE_mrad_s / config->motor.pole_pairs;
    return (as_fast || (state->confirmed && !hall)) &&
           (q_abs(state->current_steps) >= CURRENT_STEPS ||
            (state->confirmed && emf_exceeds(config, in, SLIPPED_SPEEDS))) &&
           apart(config, in, state->confirmed && !late ? SLIPPED_TURN : slow_turn);
}

/* Consecutive steps with a current of one direction, counted with its sign, and with a sensor that
 * shows no turning rotor: below half of the observer's speed, or a quarter more than the observer.
 * Halls show the mean of a turn, also of a wheel that stops meanwhile. */
static void count_steps(angle_choice_state_t *state, const config_t *config, const rotor_view_t *in)
{
    const int32_t sign = (in->i_pu.q >= LEAST_PU) - (in->i_pu.q <= -LEAST_PU);
    const int32_t before = sign * state->current_steps > 0 ? state->current_steps : 0;
    state->current_steps = (int8_t)q_limit(before + sign, CURRENT_STEPS);
    const int32_t size_mrad_s = q_abs(in->observer_mrad_s);
    const bool more = in->acquired && q_abs(in->sensor_mrad_s) - size_mrad_s > size_mrad_s / 4;
    const bool turns = shows_turning(config, in) && !more;
    state->rest_steps = (uint8_t)q_clamp(state->rest_steps + (turns ? -1 : 1), 0, 2 * REST_STEPS);
}

/* Halls that have turned round, or are at rest, show no more than their sector. */
static int32_t opposed_turn(const config_t *config, const rotor_view_t *in)
{
    const bool stands = config->rotor.sensor == CONFIG_ROTOR_HALL && in->sensor_mrad_s == 0;
    return stands ? STANDING_TURN : OPPOSED_TURN;
}

/* Is the sensor further from the observer than any healthy one? An observer that is not confirmed
 * is of dead time alone where no current shows which sign that has, as in a wheel that has just
 * stopped. */
static bool opposes(const angle_choice_state_t *state, const config_t *config,
                    const rotor_view_t *in)
{
    const bool hall = config->rotor.sensor == CONFIG_ROTOR_HALL;
    return (state->confirmed || state->current_steps != 0) &&
           q_abs(in->difference_turn) >= opposed_turn(config, in) &&
           apart(config, in, hall ? LATE_TURN : SLIPPED_TURN);
}

/* Where the sensor has shown a rotor near rest for a while, a current that changes may leave the
 * observer with the flux of one that turns. */
static int32_t opposed_steps(const angle_choice_state_t *state, const config_t *config,
                             const rotor_view_t *in, bool lacks)
{
    const bool rests = state->rest_steps >= REST_STEPS;
    if (state->confirmed && (!rests || emf_exceeds(config, in, OPPOSED_SPEEDS))) {
        return OPPOSED_STEPS;
    }
    const int32_t slow = rests ? OPPOSED_REST_STEPS : OPPOSED_SLOW_STEPS;
    return lacks ? LACKING_STEPS : slow;
}

/* A sensor that is wrong agrees with the observer in passing: it has to for a long time. */
static void compare(angle_choice_state_t *state, const config_t *config, const rotor_view_t *in)
{
    const bool lacks = state->lacks_flux && in->switching && shows_turning(config, in);
    if (!(lacks || watches(state, config, in)) || !in->sensor_valid) {
        state->opposed_steps = 0;
        state->slipped = 0;
        state->agreed_steps = 0;
        return;
    }
    state->opposed_steps = counted(state->opposed_steps, lacks || opposes(state, config, in));
    if (slips(state, config, in)) {
        state->slipped = (uint8_t)q_min(state->slipped + (state->confirmed ? 1 : 2), SLIPPED_STEPS);
    } else if (state->slipped > 0) {
        state->slipped--;
    }
    state->agreed_steps =
        q_abs(in->difference_turn) < AGREED_TURN && state->confirmed
            ? q_min(state->agreed_steps + 1, config->monitor.rotor_warning_time_ms)
            : 0;
    if (state->opposed_steps >= opposed_steps(state, config, in, lacks) ||
        state->slipped >= SLIPPED_STEPS) {
        state->sensor_wrong = true;
    } else if (state->agreed_steps >= config->monitor.rotor_warning_time_ms) {
        state->sensor_wrong = false;
    }
}

/* Halls and an absolute angle that have contradicted themselves are soon valid again, with whatever
 * angle they show now. Where no confirmed observer sees whether it is right they are wrong then,
 * and where the observer does not even watch at once; an encoder returns with a confirmed index. */
static void watch_return(angle_choice_state_t *state, const config_t *config,
                         const rotor_view_t *in)
{
    const bool slow = q_abs(in->sensor_mrad_s / 2) < config->rotor.observer_speed_mrad_s / 2;
    const bool fails = state->was_valid && config->rotor.sensor != CONFIG_ROTOR_ENCODER &&
                       !state->confirmed; /* if it is invalid now */
    const bool creeps = !shows_turning(config, in) && !watches(state, config, in);
    if (in->switching && (in->sensor_valid ? state->failed : fails && creeps)) {
        state->sensor_wrong = true;
    }
    state->failed = in->switching && !in->sensor_valid && (state->failed || (fails && slow));
    state->was_valid = in->sensor_valid;
}

static reason_t name_of(const rotor_view_t *in)
{
    const int32_t sensor_mrad_s = q_max(in->sensor_mrad_s, -INT32_MAX);
    const int32_t along_mrad_s = in->observer_mrad_s >= 0 ? sensor_mrad_s : -sensor_mrad_s;
    const int32_t half_mrad_s = q_abs(in->observer_mrad_s) / 2;
    if (along_mrad_s >= half_mrad_s) {
        return REASON_ROTOR_SLIPPED;
    }
    return along_mrad_s > -half_mrad_s ? REASON_ROTOR_FROZEN : REASON_ROTOR_REVERSED;
}

/* Once, for as long as the sensor is wrong. */
static void name_sensor(angle_choice_state_t *state, const config_t *config, const rotor_view_t *in)
{
    state->wrong_steps = counted(state->wrong_steps, state->sensor_wrong);
    const bool slips = state->wrong_steps == 1 && state->slipped >= SLIPPED_STEPS;
    if (!state->sensor_wrong) {
        state->name = REASON_NONE;
    } else if (slips) {
        state->name = REASON_ROTOR_SLIPPED; /* so near for so long: it turns as fast */
    } else if (state->name == REASON_NONE && state->wrong_steps >= NAME_STEPS) {
        /* An observer that is gone by then was wrong itself, as in a wheel that locks. */
        state->name = watches(state, config, in) ? name_of(in) : REASON_ROTOR_UNCERTAIN;
    }
}

/* A sensor that was invalid has lost its place, maybe: it is used again once it agrees, or once the
 * observer cannot tell. */
static bool may_return(const angle_choice_state_t *state, const config_t *config,
                       const rotor_view_t *in)
{
    return !state->observer_used || !state->confirmed || !apart(config, in, AGREED_TURN);
}

void angle_choice_init(angle_choice_state_t *state)
{
    const angle_choice_state_t fresh = {.confirmed = false};
    *state = fresh;
}

angle_choice_t angle_choice_step(angle_choice_state_t *state, const config_t *config,
                                 const rotor_view_t *in, bool cleared)
{
    if (config->rotor.observer_takeover == 0) {
        const angle_choice_t sensor_alone = {.valid = in->sensor_valid};
        return sensor_alone;
    }
    confirm(state, config, in);
    count_steps(state, config, in);
    compare(state, config, in);
    watch_return(state, config, in);
    state->sensor_wrong = state->sensor_wrong && !(cleared && !in->switching);
    name_sensor(state, config, in);
    const bool sensor = in->sensor_valid && !state->sensor_wrong && may_return(state, config, in);
    state->observer_used =
        !sensor && (state->observer_used || watches(state, config, in) || !in->switching);
    const angle_choice_t out = {
        .valid = sensor || (state->observer_used && state->confirmed),
        .by = state->observer_used ? ANGLE_BY_OBSERVER : ANGLE_BY_SENSOR,
        .sensor_wrong = state->sensor_wrong,
        .observed = state->confirmed,
        .name = state->name,
    };
    return out;
}
