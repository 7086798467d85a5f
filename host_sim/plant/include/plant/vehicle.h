/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vehicle.h: a mass on wheels that do not slip, moving along a road (wheels that do: chassis.h,
 * tyre.h).
 *
 *     m dv/dt = torques / r - 1/2 rho c_d A u|u| - m g sin(slope) - friction        u = v + wind
 *
 * Friction (rolling resistance, brakes, bearings) is a capacity: while the vehicle rolls it opposes
 * with all of it; when less is enough to stop within the step, exactly that much is used, and a
 * standing vehicle does not move as long as the capacity suffices. Solved as an implicit impulse,
 * so a stop ends at speed zero without chatter.
 *
 * Energies use the mean speed of the step, for which kinetic energy changes by force times way
 * exactly. r is the rolling radius over the gear ratio; rotating masses are counted in m.
 */
#ifndef PLANT_VEHICLE_H
#define PLANT_VEHICLE_H

#include "plant/parameter.h"

/* clang-format off */
#define VEHICLE_PARAMETERS(X) \
    X(mass_kg,             0.01, 1e6,  "kg", "with load and what rotates") \
    X(wheel_radius_m,      1e-3, 10.0, "m", \
      "rolling radius, divided by the gear ratio where there is a gear") \
    X(frontal_area_m2,     0.0,  100.0, "m2", "") \
    X(drag_coefficient,    0.0,  10.0, "1",  "") \
    X(rolling_resistance,  0.0,  1.0,  "1",  "share of the normal force") \
    X(driven_wheels,       1.0,  16.0, "1", \
      "wheels with a motor, a controller and a brake; the others roll along")

#define ROAD_PARAMETERS(X) \
    X(air_density_kg_per_m3, 0.0,  10.0, "kg/m3", "dry air at 20 degC and sea level: 1.204") \
    X(gravity_m_per_s2,      0.0,  30.0, "m/s2",  "") \
    X(friction,              0.0,  3.0,  "1", \
      "of tyre and road, sticking; 0: wheels cannot slip") \
    X(slope,                -1.0,  1.0,  "1",     "rise over run, positive uphill") \
    X(wind_m_per_s,         -60.0, 60.0, "m/s", \
      "along the road, positive against a vehicle that drives forward")
/* clang-format on */

typedef struct {
    VEHICLE_PARAMETERS(PLANT_PARAMETER_MEMBER)
} vehicle_params_t;

typedef struct {
    ROAD_PARAMETERS(PLANT_PARAMETER_MEMBER)
} road_params_t;

typedef struct {
    double speed_m_per_s;         /* positive forward */
    double acceleration_m_per_s2; /* of the last step */
    double distance_m;
    double height_m;
} vehicle_state_t;

/* What the wheels did during a step, all wheels together. */
typedef struct {
    double torque_impulse_nms;   /* of the motors and everything else that is not friction, forward
                                    positive */
    double friction_capacity_nm; /* of brakes and bearings, magnitude */
} vehicle_load_t;

/* Work and heat of a step. */
typedef struct {
    double mean_speed_m_per_s;
    double friction_used; /* active share of every friction capacity, -1 .. 1, positive against
                             forward motion */
    double drag_j;
    double rolling_j;
    double climbed_j; /* potential energy gained */
} vehicle_flow_t;

/* A vehicle on one road: forces in N, positive when they slow a forward motion. */
typedef struct {
    double mass_kg;
    double wheel_radius_m;
    double drag_n_s2_per_m2; /* of u|u| */
    double wind_m_per_s;
    double rolling_n; /* capacity */
    double weight_n;  /* square to the road */
    double slope_n;
    double rise; /* height gained on a metre of way */
    double per_mass_1_per_kg, per_radius_1_per_m;
} vehicle_t;

vehicle_t vehicle_on_road(const vehicle_params_t *params, const road_params_t *road);

double vehicle_drag_n(const vehicle_t *vehicle, double speed_m_per_s);

vehicle_flow_t vehicle_step(const vehicle_t *vehicle, vehicle_state_t *state,
                            const vehicle_load_t *load, double step_s);

/* Speed expected in the middle of a step, from the acceleration of the last one. */
double vehicle_expected_speed_m_per_s(const vehicle_state_t *state, double step_s);

double vehicle_kinetic_energy_j(const vehicle_t *vehicle, const vehicle_state_t *state);

#endif
