/* SPDX-License-Identifier: Apache-2.0 */
/*
 * parameter.h: how a model declares its parameters, one line each:
 *
 *     X(name_unit, smallest accepted value, largest accepted value, "unit", "meaning")
 *
 * The list makes the model's parameter struct here and the table of names that scenarios and drive
 * files set there (bench/parameters.h), so a parameter exists in one place only. Every parameter is
 * a double in SI units; a zeroed struct is not a valid machine, values come from a drive's TOML
 * file.
 */
#ifndef PLANT_PARAMETER_H
#define PLANT_PARAMETER_H

#define PLANT_PARAMETER_MEMBER(name, lowest, highest, unit, text) double name;

#endif
