/* SPDX-License-Identifier: Apache-2.0 */
/*
 * engine.h: the bench as a library for other languages: create, set by name, load a configuration,
 * run, read by name.
 *
 * Plain declarations only, so that a foreign-function reader (cffi and the like) can take this file
 * as it is, less the lines that begin with '#'. Functions that can fail return HUBSIM_OK or another
 * code of the enumeration below; hubsim_error() then returns one line with the error and the
 * accepted values. No function prints, exits or keeps anything outside the handle, so any number of
 * handles may run at the same time, one thread each.
 *
 * Order of a run: hubsim_new, hubsim_set for every parameter, hubsim_set_voltage_curve,
 * hubsim_set_energy_map and hubsim_set_trace if there is one, hubsim_load_config, hubsim_start,
 * hubsim_choose, hubsim_run until it returns HUBSIM_ENDED or enough time has passed, hubsim_value
 * for the accounts, hubsim_delete. hubsim_set also works between calls of hubsim_run: that is how
 * events happen.
 */
#ifndef BENCH_ENGINE_H
#define BENCH_ENGINE_H

#include <stdint.h>

enum {
    HUBSIM_OK = 0,
    HUBSIM_ENDED = 1,       /* the run reached the end set by its parameters */
    HUBSIM_FULL = 2,        /* no space for another row; call again with an empty buffer */
    HUBSIM_BAD_NAME = -1,   /* no parameter or signal of that name */
    HUBSIM_BAD_VALUE = -2,  /* outside the accepted range */
    HUBSIM_BAD_CONFIG = -3, /* refused by the firmware's own validator */
    HUBSIM_BAD_ORDER = -4,  /* something must be called first */
    HUBSIM_FAILED = -5      /* the run cannot continue; hubsim_error() returns the cause */
};

typedef struct hubsim hubsim_t;

/* NULL when there is no memory. */
hubsim_t *hubsim_new(void);
void hubsim_delete(hubsim_t *sim);

/* The last failure in words; never NULL, valid until the next call on this handle. */
const char *hubsim_error(const hubsim_t *sim);

/* Parameters: 0 <= index < count. NULL and 0 outside. */
int hubsim_parameter_count(void);
const char *hubsim_parameter_name(int index);
const char *hubsim_parameter_unit(int index);
const char *hubsim_parameter_text(int index);
double hubsim_parameter_lowest(int index);
double hubsim_parameter_highest(int index);

int hubsim_set(hubsim_t *sim, const char *name, double value);
int hubsim_get(const hubsim_t *sim, const char *name, double *value);

/* Open-circuit voltage over state of charge, 1 to 64 points with rising soc. */
int hubsim_set_voltage_curve(hubsim_t *sim, const double *soc, const double *voltage_v, int points);

/*
 * What the iron of every motor adds to its inductances (plant/energy_map.h): coefficients in J of
 * 3/2 of three phases, for every j along d those of all k along q behind each other, cells + 3 of
 * them along an axis, over the fluxes beside motor.flux_linkage_wb.
 */
typedef struct {
    double d_first_wb, d_step_wb, q_first_wb, q_step_wb;
    int d_cells, q_cells; /* 1 to 200 */
    const double *coefficient_j;
} hubsim_energy_map_t;

/* Before hubsim_start; copied. */
int hubsim_set_energy_map(hubsim_t *sim, const hubsim_energy_map_t *map);

/* Speed over time for driver.follow_trace, times rising from 0; copied. */
int hubsim_set_trace(hubsim_t *sim, const double *time_s, const double *speed_m_per_s, int points);

/* The image of config_t that every controller of the vehicle gets; copied. */
int hubsim_load_config(hubsim_t *sim, const void *image, uint32_t size_bytes);

/*
 * Front and rear drives that differ, before hubsim_start: the wheels from chassis.wheels_per_axle
 * on get motor, inverter, brake, sensors, temperatures and configuration of `rear`, a handle that
 * was given everything but was not started; this one deletes it. Vehicle, battery and driver are
 * this handle's, and a parameter set during the run is that of both. Refused with hubsim_processor
 * and hubsim_external_take.
 */
int hubsim_set_rear(hubsim_t *sim, hubsim_t *rear);

/*
 * Processor in the loop, before hubsim_start: the controllers' steps are executed by the program
 * host_sim/pil/target.c on an emulated core whose RAM is the file `path`. Waits until it is ready,
 * 20 s at most. hubsim_save and hubsim_restore are refused then.
 */
int hubsim_processor(hubsim_t *sim, const char *path);

/*
 * The whole application (interrupts, CAN frames, main loop, watchdog) on its simulated board in the
 * place of every wheel's two steps, before hubsim_start: `path` is libhubsim_application, of which
 * each wheel gets a copy. The controllers' own signals (limits, temperatures in use, estimated
 * angle) are then constant, because CAN does not contain them. hubsim_save and hubsim_restore are
 * refused.
 */
int hubsim_application(hubsim_t *sim, const char *path);

/* A frame on the bus of the vehicle whose wheels have the whole application. */
typedef struct {
    uint32_t identifier; /* of 11 bits; with bit 31 of 29, from a wheel to displays alone */
    uint8_t length;
    uint8_t data[8];
} hubsim_frame_t;

/* After hubsim_start with hubsim_application: a frame from outside to every wheel; and at most
 * `capacity` of the frames that wheels, battery and brakes have sent since the last call. Returns
 * their number, negative: an error. What nobody reads for some milliseconds is lost. */
int hubsim_bus_send(hubsim_t *sim, const hubsim_frame_t *frame);
int hubsim_bus_read(hubsim_t *sim, hubsim_frame_t *frames, int capacity);

/* The serial line of one wheel's application: at most `size` bytes that it wrote, their number
 * returned; and typing on it. */
int hubsim_serial_take(hubsim_t *sim, int wheel, char *bytes, int size);
int hubsim_serial_type(hubsim_t *sim, int wheel, const char *bytes, int size);

/* The service protocol of one wheel's application, beside CAN: a packet to it, of 1 to 40 bytes;
 * and those that it sent, each behind a byte with its length, as many as fit into `size`, the bytes
 * of all returned. */
int hubsim_packet_send(hubsim_t *sim, int wheel, const void *bytes, int length);
int hubsim_packets_take(hubsim_t *sim, int wheel, void *bytes, int size);

/* Boot the controllers and bring the vehicle to its initial speed; time is 0 afterwards. */
int hubsim_start(hubsim_t *sim);

/* Signals, known after hubsim_start. name: at most `size` characters are written, terminated. */
int hubsim_signal_count(const hubsim_t *sim);
int hubsim_signal_name(const hubsim_t *sim, int index, char *name, int size);

/* Unit ("N.m", "m/s2", "1" for a share, "" for a code or a flag) and meaning; NULL outside 0 <=
 * index < count. */
const char *hubsim_signal_unit(const hubsim_t *sim, int index);
const char *hubsim_signal_text(const hubsim_t *sim, int index);

/* Which signals hubsim_run records, as indices. */
int hubsim_choose(hubsim_t *sim, const int *indices, int count);

/*
 * Run for duration_s or until the run ends, and write rows of the chosen signals at every
 * run.record_interval_s. rows: space for `capacity` rows of as many doubles as signals were chosen;
 * *written: rows written. With HUBSIM_FULL the clock is at the first row without space;
 * *remaining_s is the remainder of duration_s.
 */
int hubsim_run(hubsim_t *sim, double duration_s, double *rows, int64_t capacity, int64_t *written,
               double *remaining_s);

/*
 * The same for whoever keeps the clock: run to a time, at most to the end of the run, and record
 * no row; one row of the chosen signals now, rates as means since the row before. At equal times
 * rows are those of hubsim_run.
 */
int hubsim_advance(hubsim_t *sim, double until_s);
int hubsim_sample(hubsim_t *sim, double *row);

/* A running vehicle with parameters, recorder and all, as bytes that mean something to this very
 * library only; a speed trace and an energy map are not part of them. Restored into a started
 * handle it goes on exactly where it was. */
uint32_t hubsim_state_bytes(void);
int hubsim_save(hubsim_t *sim, void *state);
int hubsim_restore(hubsim_t *sim, const void *state);

/* The value of a signal now; rates are given as the account they are the rate of. */
int hubsim_value(const hubsim_t *sim, const char *name, double *value);

/* Words for the numbers in the signals `mode` and `reason`; never NULL. */
const char *hubsim_mode_text(int mode);
const char *hubsim_reason_text(int reason);

#endif
