/* SPDX-License-Identifier: Apache-2.0 */
/* The tables that plant_values.py writes from the drives' TOML files. */
#ifndef TEST_PLANT_VALUES_H
#define TEST_PLANT_VALUES_H

typedef struct {
    const char *name;
    double value;
} plant_value_t;

typedef struct {
    const char *name; /* of the TOML file */
    const plant_value_t *values;
    int count;
    const double *soc, *voltage_v; /* open-circuit voltage over state of charge */
    int voltage_points;
} plant_drive_t;

/* In the order of the command line; the paper's vehicle comes first. */
extern const plant_drive_t PLANT_DRIVES[];
extern const int PLANT_DRIVES_COUNT;

#endif
