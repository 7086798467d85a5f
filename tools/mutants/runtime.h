/* SPDX-License-Identifier: Apache-2.0 */
/* Included before everything else in what mutation testing compiles. */
#ifndef HUBFOC_MUTANT_RUNTIME_H
#define HUBFOC_MUTANT_RUNTIME_H

extern int hubfoc_mutant;              /* number of the mutant that acts, 0 for none */
extern unsigned char hubfoc_reached[]; /* by number: its place was evaluated, and with a value that
                                          the mutant changes where that can be told */

#define HUBFOC_MUTANT(number) (hubfoc_reached[number] = 1, hubfoc_mutant == (number))

/* The mutant of an expression without effects: without a mutant both values are compared. */
#define HUBFOC_VALUE(number, differs)                                                              \
    ((void)(hubfoc_mutant == 0 && (differs) && (hubfoc_reached[number] = 1)),                      \
     hubfoc_mutant == (number))

#endif
