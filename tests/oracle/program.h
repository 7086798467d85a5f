/* SPDX-License-Identifier: Apache-2.0 */
/*
 * program.h: what the oracle's programs have in common. They print a line for each entry,
 *
 *     entry <name>: <fast> <slow> <events> <bytes> <fast steps> <slow steps>
 *
 * and at the end what was reached, "reached <list> <number>: <slow steps>". Options, behind the
 * program's own arguments:
 *
 *     --values FILE NUMBER  lists every change of a value (hashing.h) in the entry of that number,
 *                         from 0
 *
 *     --change NAME STEP    adds one to a value of the first entry
 */
#ifndef ORACLE_PROGRAM_H
#define ORACLE_PROGRAM_H

#include "hashing.h"

/* Reads the options among the arguments from `first` on, and begins the first entry. False, with a
 * message: one is unknown. with_reports: as for oracle_begin(). */
int program_begin(int count, char **arguments, int first, int with_reports);

/* Prints the hashes of the entry that ends, and begins the next one. */
void program_entry(const char *name);

void program_end(void);

#endif
