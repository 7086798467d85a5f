/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.c: ends the emulator after a number of instructions. A plugin for QEMU's TCG.
 *
 *     -plugin limit.so,instructions=NUMBER[,report=on]
 *
 * The result does not depend on the speed or the load of the machine. The emulated program is
 * stopped at the end of the first block of code beyond the number, with exit status 124 and a line
 * on stderr. report: print the number of instructions when the emulator ends by itself.
 *
 * The packages of QEMU carry no header for plugins; the declarations below are the documented
 * interface. Its version (QEMU_PLUGIN_API) must be one that the emulator accepts; the functions
 * used here are the same in all of them.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_info_t;
enum { QEMU_PLUGIN_CB_NO_REGS = 0, EXIT_STATUS = 124 };
typedef void (*translate_cb_t)(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void (*execute_cb_t)(unsigned, void *);
typedef void (*exit_cb_t)(qemu_plugin_id_t, void *);

size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, translate_cb_t);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, execute_cb_t, int, void *);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, exit_cb_t, void *);

EXPORT int qemu_plugin_version = QEMU_PLUGIN_API;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc,
                               char **argv);

static uint64_t executed;
static uint64_t limit;

static void on_block(unsigned cpu, void *instructions)
{
    (void)cpu;
    executed += (uintptr_t)instructions;
    if (executed > limit) {
        fprintf(stderr, "instruction limit: more than %" PRIu64 " executed\n", limit);
        _exit(EXIT_STATUS); /* output is unbuffered; the handlers of exit() expect another thread */
    }
}

static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb *block)
{
    (void)id;
    qemu_plugin_register_vcpu_tb_exec_cb(block, on_block, QEMU_PLUGIN_CB_NO_REGS,
                                         (void *)(uintptr_t)qemu_plugin_tb_n_insns(block));
}

static void on_end(qemu_plugin_id_t id, void *user)
{
    (void)id;
    (void)user;
    fprintf(stderr, "%" PRIu64 " instructions executed\n", executed);
}

int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (strncmp(argv[i], "instructions=", 13) == 0) {
            limit = strtoull(argv[i] + 13, NULL, 10);
        } else if (strcmp(argv[i], "report=on") == 0) {
            qemu_plugin_register_atexit_cb(id, on_end, NULL);
        } else {
            fprintf(stderr, "limit plugin: cannot use %s\n", argv[i]);
            return -1;
        }
    }
    if (limit == 0) {
        fprintf(stderr, "limit plugin: instructions=NUMBER is missing\n");
        return -1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    return 0;
}
