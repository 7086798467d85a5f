/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow_messages.h: input and output of the slow step, once per millisecond.
 *
 * Plain values. The application, the CAN messages (comms), the simulator, the FMU and Python use
 * these structures without a copy of their own (names, units and ranges: host_sim/exchange).
 *
 * Signs: motor torque, current and speed are positive when they drive forward; braking torques and
 * the limits of the pack are magnitudes >= 0; the bus current is positive out of the battery.
 */
#ifndef CORE_SLOW_MESSAGES_H
#define CORE_SLOW_MESSAGES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/drive_direction.h"
#include "core/operating_mode.h"
#include "core/reason.h"
#include "core/waits_for.h"

/* What the vehicle demands of this wheel: the CAN message Demand, or a pedal. */
typedef struct {
    int32_t drive_torque_mNm; /* signed, positive forward; against `direction` it is lift-off
                                 braking */
    int32_t brake_torque_mNm; /* magnitude >= 0, motor and hydraulic brake together */
    drive_direction_t direction;
    bool enable;      /* the driver has switched the vehicle on */
    bool abs_active;  /* the anti-lock system intervenes: electric braking only as it permits */
    bool fault_reset; /* rising edge acknowledges a latched fault; honoured only without
                         torque demand */
    uint8_t abs_motor_share_percent; /* largest share of brake_torque_mNm that the motor makes while
                                        abs_active, 0 .. 100; more counts as 100 */
    /* Why a torque is not what the pedal says, REASON_NONE: it is. From REASON_FIRST_FAULT on it is
     * a warning. */
    reason_t reason;
} wheel_demand_t;

/* State of the pack's main contactor; the numbers are part of the protocol. */
typedef enum {
    CONTACTOR_NOT_REPORTED = 0, /* counts as closed */
    CONTACTOR_CLOSED = 1,
    CONTACTOR_OPEN = 2
} contactor_t;

/* What the battery management allows now, of the whole pack: the CAN message BatteryLimits. */
typedef struct {
    int32_t charge_current_mA;    /* magnitude >= 0 */
    int32_t discharge_current_mA; /* magnitude >= 0 */
    /* Magnitude >= 0, for as long as the hydraulic brake takes to come; 0: not given. The CAN
     * message BatteryPeak. */
    int32_t charge_peak_current_mA;
    int32_t voltage_mV; /* at its terminals, >= 0; 0: not given. The CAN message BatteryPeak. */
    int32_t current_mA; /* measured, of the whole pack, positive out of it; BatteryPeak as well */
    contactor_t contactor;
    bool current_given; /* false: current_mA is not looked at */
} battery_limits_t;

/* The measured torque of this wheel's hydraulic brake: the CAN message HydraulicFeedback. */
typedef struct {
    int32_t torque_mNm; /* magnitude */
    uint32_t age_ms;    /* since it was received */
    bool valid;         /* received, and the sensor takes it for plausible */
} hydraulic_feedback_t;

/* Measured by the board; 29 999 or more: sensor broken or not connected. */
typedef struct {
    int32_t winding_cC;
    int32_t switch_cC;
} wheel_temperatures_t;

typedef struct {
    wheel_demand_t demand;
    uint32_t demand_age_ms; /* since the last valid demand; beyond config.brake.demand_timeout_ms
                               it counts as lost */
    battery_limits_t bms;
    hydraulic_feedback_t hydraulic;
    wheel_temperatures_t temperature;
    bool selftest_passed; /* the board's own power-up checks; stays true afterwards */
    bool config_accepted; /* config_validate() has accepted it at boot. With a refused one no step
                             may be called; false keeps the mode in BOOT while the check is
                             pending */
} slow_input_t;

typedef struct {
    int32_t motor_torque_command_mNm;  /* signed: present torque setpoint */
    int32_t motor_torque_estimate_mNm; /* signed: from measured currents, at the shaft */
    /* Standard uncertainty of the estimate, >= 0 (motor/torque_uncertainty.h); at most 16 ms old.
     * INT32_MAX: unknown, the angle is not the sensor's. Information: nothing depends on it. */
    int32_t motor_torque_uncertainty_mNm;
    int32_t hydraulic_torque_mNm;         /* command to the hydraulic brake, magnitude >= 0 */
    int32_t electric_brake_available_mNm; /* braking torque limit of the motor, magnitude >= 0 */
    int32_t electric_brake_ahead_mNm;     /* expected 300 ms later, magnitude >= 0 */
    int32_t drive_available_mNm;          /* driving torque limit, magnitude >= 0 */
    int32_t drive_ahead_mNm;              /* expected 300 ms later, magnitude >= 0 */
    int32_t speed_mrad_s;                 /* mechanical, signed */
    int32_t i_d_mA, i_q_mA;               /* mean over the latest millisecond, peak phase values */
    int32_t bus_voltage_mV;
    int32_t bus_current_mA;    /* estimate from applied voltage and measured current */
    reason_t torque_reason;    /* what bounds the motor torque in the demanded direction, at most
                                  five changes in a second (shown_reason.h) */
    reason_t available_reason; /* what bounds electric_brake_available_mNm */
    reason_t ahead_reason;     /* what will bound electric_brake_ahead_mNm */
    reason_t drive_available_reason, drive_ahead_reason;
    reason_t hydraulic_reason; /* REASON_HYDRAULIC_LIMIT: motor and hydraulic brake together
                                  cannot meet the demand */
    reason_t fault_reason;     /* the latched fault, REASON_NONE when healthy */
    operating_mode_t mode;
    waits_for_t waits_for;       /* what driving torque waits for */
    reason_t warning_reason;     /* the latched warning, else the present one; REASON_NONE: none */
    reason_t present_warning;    /* for the black box, which counts one behind a latched one too */
    drive_direction_t direction; /* in which driving torque is made now; NEUTRAL: none is */
    bool hydraulic_valid; /* false: the demand is lost and no hold works; the brake system uses its
                             own path instead of hydraulic_torque_mNm */
    bool stop_lamp;
    bool standstill; /* the speed upper bound is below monitor.standstill (monitor_speed.h) */
} slow_output_t;

#endif
