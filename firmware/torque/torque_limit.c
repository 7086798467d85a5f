#include "torque/torque_limit.h"

#include "core/q15.h"
#include "core/ramp.h"
#include "torque/demand.h"

void torque_limit_init(torque_limit_state_t *state)
{
    state->command_mNm = 0;
}

/* A driving demand against the rotation is braking by the drive pedal: it feeds the battery and obeys that side's
 * limits; one along the rotation, or at standstill, obeys the driving side's. */
static limit_t drive_limit(const capability_t *capability, const permission_t *permission, int32_t speed_mrad_s,
                           int32_t drive_mNm)
{
    const bool against = (speed_mrad_s > 0 && drive_mNm < 0) || (speed_mrad_s < 0 && drive_mNm > 0);
    limit_t limit = against ? capability->regenerating : capability->driving;
    limit_derate(&limit, against ? permission->brake_q15 : permission->drive_q15, permission->reason);
    return limit;
}

torque_limit_out_t torque_limit_step(torque_limit_state_t *state, const config_t *config,
                                     const capability_t *capability, const permission_t *permission,
                                     int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    torque_limit_out_t out = {.command_mNm = 0, .reason = REASON_NONE};
    if (permission->bridge != BRIDGE_PWM) {
        out.reason = drive_mNm != 0 || electric_mNm != 0 ? permission->reason : REASON_NONE;
        state->command_mNm = 0;
        return out;
    }
    const limit_t bound = drive_limit(capability, permission, speed_mrad_s, drive_mNm);
    limit_t driving = limit_init(q_abs(drive_mNm), REASON_NONE);
    limit_tighten(&driving, bound.torque_mNm, bound.reason);
    const int32_t drive_part_mNm = drive_mNm >= 0 ? driving.torque_mNm : -driving.torque_mNm;
    const int32_t brake_part_mNm = speed_mrad_s >= 0 ? -electric_mNm : electric_mNm;
    const int32_t target_mNm = drive_part_mNm + brake_part_mNm;

    state->command_mNm = ramp_step(state->command_mNm, target_mNm, demand_rate_mNm_per_step(config));
    out.command_mNm = state->command_mNm;
    out.reason = out.command_mNm != target_mNm ? REASON_TORQUE_RATE : driving.reason;
    return out;
}
