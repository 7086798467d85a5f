/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/controller.h"
#include "fast_output.h"
#include "monitor/monitor_fast.h"

/* What the bridge does; the only place that decides it. */
static bridge_mode_t bridge_command(const fast_setpoint_t *setpoint, bool enabled, reason_t trip)
{
    return enabled && trip == REASON_NONE ? BRIDGE_PWM : setpoint->safe_bridge;
}

const fast_output_t *controller_fast_step(controller_fast_t *fast, const config_t *config,
                                          const fast_setpoint_t *setpoint, const fast_input_t *in)
{
    const bool enabled = setpoint->torque_enabled;
    if (enabled && fast->monitor.trip == REASON_NONE) {
        if (foc_step(&fast->foc, config, setpoint, in)) {
            monitor_fast_trip(&fast->monitor, REASON_CURRENT_SENSOR);
        }
    } else {
        foc_idle_step(&fast->foc, config, setpoint, in);
    }

    const foc_period_t *period = foc_latest(&fast->foc);
    const monitor_fast_input_t watched = {
        .i_pu = period->i_pu,
        .v_dc_pu = period->v_dc_pu,
        .power_stage_fault = in->power_stage_fault,
        .switching = enabled,
        .clear_trip = setpoint->clear_trip,
        .slow_step_count = setpoint->sequence,
        .least_square = setpoint->least_square,
    };
    const reason_t trip = monitor_fast_step(&fast->monitor, &watched);
    fast_output_write(fast, bridge_command(setpoint, enabled, trip));
    return &fast->output;
}

void controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report)
{
    report->trip = fast->monitor.trip;
    report->bridge = fast->output.bridge;
    foc_report_copy(&fast->foc, report);
}

void controller_fast_view(const controller_fast_t *fast, fast_view_t *view)
{
    foc_view(&fast->foc, view);
}
