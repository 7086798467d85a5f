/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault.h: every fault that can be injected, by name, as parameters "fault.name"; all 0: healthy.
 *
 * Currents are shares of the full scale of the current converters and bus voltages shares of that
 * of the bus converter, so that one number suits every drive. A fault begins when its parameter
 * leaves 0 and, where the physics allows, ends when it returns. The names people use, with meaning
 * and values, are in python/hubsim/scenario/faults.toml. Further faults are parameters of their own
 * models: sensors.hall_stuck_low, brake.torque_loss, winding_sensor.open and so on.
 */
#ifndef PLANT_FAULT_H
#define PLANT_FAULT_H

#include "plant/parameter.h"

/* clang-format off */
#define SENSOR_FAULT_PARAMETERS(X) \
    X(current_sensors,       0.0,   7.0,    "", \
      "current sensors concerned: 1 = a, 2 = b, 4 = c, sums") \
    X(current_stuck,         0.0,   1.0,    "",    "1: they show current_shown") \
    X(current_shown,        -1.0,   1.0,    "1",   "of the full scale; 0: no current") \
    X(current_frozen,        0.0,   1.0,    "",    "1: they show the last code for ever") \
    X(current_offset,       -2.0,   2.0,    "1",   "of the full scale, added") \
    X(current_drift_per_s,  -2.0,   2.0,    "1/s", "of the full scale, growth of an offset") \
    X(current_gain_error,   -1.0,   2.0,    "1",   "share of the current shown too much") \
    X(bus_stuck,             0.0,   1.0,    "",    "1: the bus sensor shows bus_shown") \
    X(bus_shown,             0.0,   1.0,    "1",   "of the full scale") \
    X(bus_frozen,            0.0,   1.0,    "",    "1: it shows the last code for ever") \
    X(bus_gain_error,       -1.0,   1.0,    "1",   "share of the bus voltage shown too much") \
    X(rotor_frozen,          0.0,   1.0,    "", \
      "1: halls, encoder and angle show where the rotor was") \
    X(rotor_jump_deg,       -180.0, 180.0,  "deg", "electrical, what they show too much") \
    X(rotor_slip_deg_per_s, -1e4,   1e4,    "deg/s", "electrical, growth of a further error") \
    X(rotor_reversed,        0.0,   1.0,    "", \
      "1: from now on they count against the rotor's turning") \
    X(hall_floating,         0.0,   7.0,    "", \
      "hall lines broken without a pull-up, each sample at random: 1 = A, 2 = B, 4 = C, sums") \
    X(hall_bouncing,         0.0,   7.0,    "", \
      "hall lines with a loose contact: half the time at their pull-up; likewise") \
    X(hall_bounce_s,         0.0,   1.0,    "s",   "of one contact and of one interruption") \
    X(index_lost,            0.0,   1.0,    "",    "1: the encoder's index never comes")

#define BRIDGE_FAULT_PARAMETERS(X) \
    X(phase_open,            0.0,   7.0,    "", \
      "wires broken between bridge and motor: 1 = a, 2 = b, 4 = c, sums") \
    X(phase_short,           0.0,   3.0,    "", \
      "wires joined: 1 = a and b, 2 = b and c, 3 = c and a") \
    X(phase_short_ohm,       0.0,   10.0,   "ohm", "resistance of that joint") \
    X(high_switch_open,      0.0,   7.0,    "", \
      "high-side switches that never close: 1 = a, 2 = b, 4 = c, sums") \
    X(low_switch_open,       0.0,   7.0,    "",    "low-side switches that never close") \
    X(high_switch_closed,    0.0,   7.0,    "",    "high-side switches that never open") \
    X(low_switch_closed,     0.0,   7.0,    "",    "low-side switches that never open") \
    X(leg_high,              0.0,   7.0,    "", \
      "legs whose driver keeps the high side closed and the low side open") \
    X(leg_low,               0.0,   7.0,    "",    "legs whose driver keeps the low side closed")

#define PROGRAM_FAULT_PARAMETERS(X) \
    X(slow_stopped,          0.0,   1.0,    "",    "1: the slow step is no longer called") \
    X(slow_doubled,          0.0,   1.0,    "",    "1: it is called twice a millisecond") \
    X(slow_late,             0.0,   1.0,    "", \
      "1: its setpoint reaches the fast loop a millisecond late") \
    X(fast_stopped,          0.0,   1.0,    "", \
      "1: the fast step is no longer called; the compare values stay") \
    X(fast_doubled,          0.0,   1.0,    "",    "1: it is called twice a period") \
    X(fast_late,             0.0,   1.0,    "",    "1: its output acts a period later") \
    X(restart,               0.0,   1.0,    "",    \
      "1: the controller restarts once, as by its watchdog") \
    X(restart_s,             0.0,   10.0,   "s", \
      "from that restart to the first step: bridge off, no message") \
    X(restart_cold,          0.0,   1.0,    "",    \
      "1: by a supply that went, so that nothing is retained") \
    X(state_bit,             0.0,   1e6,    "", \
      "number of a bit of the controller's state, from 1, that flips once; 0: none") \
    X(state_part,            0.0,   5.0,    "", \
      "in which part of it: 1 = mode, 2 = latched fault, 3 = trip, 4 = limit of the current, " \
      "5 = limit of the bus voltage; 0: in all of it") \
    X(config_bit,            0.0,   1e6,    "", \
      "number of a bit of the configuration, from 1, that flips; 0: none")

#define LINK_FAULT_PARAMETERS(X) \
    X(can_delay_s,           0.0,   1.0,    "s",   "frames reach the wheel so much later") \
    X(can_repeated,          0.0,   1.0,    "", \
      "1: the demand's last frame comes again and again instead of a new one") \
    X(can_replay_s,          0.0,   1.0,    "s", \
      "the frames of so many seconds from the fault on come again and again after them") \
    X(can_corrupt,           0.0,   1.0,    "1",   "share of frames of which a byte is another") \
    X(can_wrong_wheel,       0.0,   1.0,    "", \
      "1: the demand's frames are those of another wheel, under this wheel's identifier")

/* Of the whole application alone (application/application.h). */
#define BOARD_FAULT_PARAMETERS(X) \
    X(can_unsent,            0.0,   1.0,    "", \
      "1: no frame of the wheel leaves, as without an acknowledge") \
    X(can_load,              0.0,   1.0,    "1", \
      "share of the bus that more urgent frames of other nodes take")

#define FAULT_PARAMETERS(X) \
    X(wheels,                0.0,   65535.0, "", \
      "wheels with the faults of this section: 1 = first, 2 = second, 4 = third ..., sums; " \
      "0: all") \
    SENSOR_FAULT_PARAMETERS(X) \
    BRIDGE_FAULT_PARAMETERS(X) \
    X(blanking_s,            0.0,   1e-4,   "s",   "of the gate drivers' desaturation detection") \
    X(gate_driver,           0.0,   1.0,    "", \
      "1: the gate drivers have opened all switches and keep the fault line active") \
    X(wires_swapped,         0.0,   1.0,    "",    "1: wires b and c change places at the motor") \
    X(magnet_loss,           0.0,   1.0,    "1",   "share of the magnets' flux lost") \
    X(cable_rise,            0.0,   1e3,    "1", \
      "resistance of the battery's cable, in that of cable and cells, added") \
    X(cell_rise,             0.0,   1e3,    "1", \
      "series resistance of the cells added, share of it") \
    X(contactor_bounce_s,    0.0,   10.0,   "s", \
      "the contactor is open and closed in turn, so long each (needs a capacitance)") \
    X(hydraulic_late_s,      0.0,   1.0,    "s",   "dead time of the hydraulic brake added") \
    X(hydraulic_drag,        0.0,   100.0,  "1", \
      "brake torque that never releases, share of the largest hydraulic torque") \
    X(hydraulic_flicker_s,   0.0,   10.0,   "s", \
      "brake or sensor lose a share of their torque and have it again in turn, so long each") \
    X(hydraulic_flicker_loss, -1.0, 1.0,   "1",   "that share of the brake's torque") \
    X(hydraulic_report_flicker_loss, -1.0, 1.0, "1", "that share of what its sensor shows") \
    X(hydraulic_report_drift_per_s, -1.0, 1.0, "1/s", \
      "share of the torque that its sensor shows too much, growth") \
    X(hydraulic_report_stuck, 0.0, 1.0,    "",    "1: its sensor shows hydraulic_report_shown") \
    X(hydraulic_report_shown, 0.0, 1.0,    "1",   "of the largest hydraulic torque") \
    X(hydraulic_report_offset, -1.0, 1.0,  "1",   "of the largest hydraulic torque, added") \
    LINK_FAULT_PARAMETERS(X) \
    BOARD_FAULT_PARAMETERS(X) \
    PROGRAM_FAULT_PARAMETERS(X)
/* clang-format on */

typedef struct {
    FAULT_PARAMETERS(PLANT_PARAMETER_MEMBER)
} fault_params_t;

#endif
