/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plugin.c: stops the emulated core in pil_sync() (target.c) until the bench has posted a request.
 * A plugin for QEMU's TCG.
 *
 *     -plugin pil_plugin.so,memory=FILE
 *
 * memory: the file that is the machine's RAM. The emulator ends when the process that started it
 * has ended.
 *
 * The packages of QEMU carry no header for plugins; the declarations below are the documented
 * interface. Its version (QEMU_PLUGIN_API) must be one that the emulator accepts; the functions
 * used here are the same in all of them.
 */
#define _GNU_SOURCE /* syscall() */

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "message.h"
#include "wait.h"

#define EXPORT __attribute__((visibility("default")))

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
enum { QEMU_PLUGIN_CB_NO_REGS = 0 };
typedef void (*translate_cb_t)(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void (*execute_cb_t)(unsigned, void *);

size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
const char *qemu_plugin_insn_symbol(const struct qemu_plugin_insn *);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, translate_cb_t);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, execute_cb_t, int, void *);

EXPORT int qemu_plugin_version = QEMU_PLUGIN_API;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc,
                               char **argv);

static pil_memory_t *memory;
static pid_t starter;

static void on_sync(unsigned cpu, void *user)
{
    (void)cpu;
    (void)user;
    pil_wake(&memory->done, &memory->bench_sleeps);
    const uint32_t done = atomic_load(&memory->done);
    while (!pil_wait(&memory->posted, done, &memory->core_sleeps)) {
        if (getppid() != starter) {
            _exit(0);
        }
    }
}

static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb *block)
{
    (void)id;
    const size_t count = qemu_plugin_tb_n_insns(block);
    for (size_t k = 0; k < count; k++) {
        struct qemu_plugin_insn *instruction = qemu_plugin_tb_get_insn(block, k);
        const char *symbol = qemu_plugin_insn_symbol(instruction);
        if (symbol != NULL && strcmp(symbol, "pil_sync") == 0) {
            qemu_plugin_register_vcpu_insn_exec_cb(instruction, on_sync, QEMU_PLUGIN_CB_NO_REGS,
                                                   NULL);
            return; /* it is one instruction, the return */
        }
    }
}

int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (strncmp(argv[i], "memory=", 7) == 0) {
            const int file = open(argv[i] + 7, O_RDWR | O_CLOEXEC);
            memory = file < 0
                         ? MAP_FAILED
                         : mmap(NULL, PIL_FILE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
            if (memory == MAP_FAILED) {
                perror(argv[i]);
                return -1;
            }
            close(file);
        } else {
            fprintf(stderr, "pil plugin: cannot use %s\n", argv[i]);
            return -1;
        }
    }
    if (memory == NULL) {
        fprintf(stderr, "pil plugin: memory=FILE is missing\n");
        return -1;
    }
    starter = getppid();
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    return 0;
}
