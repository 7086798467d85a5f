/* SPDX-License-Identifier: Apache-2.0 */
/* math.h: of the C library, what bench/injection.c names; the linker drops its only caller. */
#ifndef FREESTANDING_MATH_H
#define FREESTANDING_MATH_H

long lround(double x);

#endif
