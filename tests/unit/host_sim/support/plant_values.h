/* The table that plant_values.py writes from a drive's TOML file. */
#ifndef TEST_PLANT_VALUES_H
#define TEST_PLANT_VALUES_H

typedef struct {
    const char *name;
    double value;
} plant_value_t;

extern const plant_value_t PLANT_VALUES[];
extern const int PLANT_VALUES_COUNT;
extern const double PLANT_SOC[];
extern const double PLANT_VOLTAGE_V[];
extern const int PLANT_VOLTAGE_POINTS;

#endif
