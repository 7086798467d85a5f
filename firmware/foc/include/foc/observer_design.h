/* SPDX-License-Identifier: Apache-2.0 */
/*
 * observer_design.h: what a configuration makes of the EMF observer: the rate at which its flux
 * decays, and fluxes as shares of its full scale, 2 psi + 5/4 L_q I_base with the largest L_q of a
 * flux map. Once, at the start; all divide. Equations: DERIVATIONS.md, EMF observer.
 */
#ifndef FOC_OBSERVER_DESIGN_H
#define FOC_OBSERVER_DESIGN_H

#include <stdint.h>

#include "config/config.h"

/* lambda T: share of its flux that the observer forgets in a period, Q24, up to 1/8. */
int32_t observer_design_leak_q24(const config_t *config);

/* Flux of R I_base in one period at the reference temperature, Q15, below 1/8. */
int32_t observer_design_resistance_q15(const config_t *config);

/* Flux of one period at the voltage circle of the bus voltage base, Q15, below 1/4.
 * modulation_limit_q15: foc_modulation_limit_q15(). */
int32_t observer_design_volt_q15(const config_t *config, int32_t modulation_limit_q15);

/* Flux of L_q I_base, Q15, below 4/5. */
int32_t observer_design_inductance_q15(const config_t *config);

/* The magnets' flux linkage, Q14, up to 1/2. */
int32_t observer_design_flux_q14(const config_t *config);

#endif
