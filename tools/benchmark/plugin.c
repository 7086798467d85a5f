/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plugin.c: counts the instructions that the emulated core executes in a call of a function. For
 * QEMU's TCG.
 *
 *     -plugin count.so,out=FILE,from=ADDRESS,fn=NAME:START:END[:END...][,fn=...]
 *
 * START is a function's first instruction, the ENDs are the instructions behind every call of it. A
 * call's count is what is executed from START up to, and without, the END reached first: the whole
 * function, its return included, the call itself not. Counting begins when FROM is executed. FILE
 * gets one line a call, when it ends: name, count, and its own part of the count, without the
 * calls of other named functions in it.
 *
 * The packages of QEMU carry no header for plugins; the few declarations below are the documented
 * interface. Its version (QEMU_PLUGIN_API) must be one that the emulator accepts; the in-line
 * counter changed its name with version 2.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
enum { QEMU_PLUGIN_CB_NO_REGS = 0, QEMU_PLUGIN_INLINE_ADD_U64 = 0 };
typedef void (*translate_cb_t)(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void (*execute_cb_t)(unsigned, void *);
typedef void (*exit_cb_t)(qemu_plugin_id_t, void *);

size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, translate_cb_t);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, execute_cb_t, int, void *);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, exit_cb_t, void *);

EXPORT int qemu_plugin_version = QEMU_PLUGIN_API;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc,
                               char **argv);

#if QEMU_PLUGIN_API == 1
void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn *, int, void *, uint64_t);
static uint64_t executed;
static void count_this(struct qemu_plugin_insn *insn)
{
    qemu_plugin_register_vcpu_insn_exec_inline(insn, QEMU_PLUGIN_INLINE_ADD_U64, &executed, 1);
}
static void prepare_counter(void) {}
static uint64_t counted(void)
{
    return executed;
}
#else
struct qemu_plugin_scoreboard;
typedef struct {
    struct qemu_plugin_scoreboard *score;
    size_t offset;
} qemu_plugin_u64;
struct qemu_plugin_scoreboard *qemu_plugin_scoreboard_new(size_t);
void qemu_plugin_register_vcpu_insn_exec_inline_per_vcpu(struct qemu_plugin_insn *, int,
                                                         qemu_plugin_u64, uint64_t);
uint64_t qemu_plugin_u64_get(qemu_plugin_u64, unsigned);
static qemu_plugin_u64 executed;
static void count_this(struct qemu_plugin_insn *insn)
{
    qemu_plugin_register_vcpu_insn_exec_inline_per_vcpu(insn, QEMU_PLUGIN_INLINE_ADD_U64, executed,
                                                        1);
}
static void prepare_counter(void)
{
    executed.score = qemu_plugin_scoreboard_new(sizeof(uint64_t));
    executed.offset = 0;
}
static uint64_t counted(void)
{
    return qemu_plugin_u64_get(executed, 0);
}
#endif

enum { FUNCTIONS_MAX = 256, ENDS_MAX = 256, DEPTH_MAX = 64 };

typedef struct {
    char name[64];
    uint64_t start;
    uint64_t end[ENDS_MAX];
    int ends;
    uint64_t at_start;
    uint64_t nested; /* of the calls of other named functions in this one */
    int open;
} function_t;

static function_t functions[FUNCTIONS_MAX];
static int function_count;
static uint64_t from_address;
static int recording;
static FILE *out;
static function_t *calls[DEPTH_MAX]; /* the present ones, the outermost first */
static int depth;

static void on_from(unsigned cpu, void *user)
{
    (void)cpu;
    (void)user;
    recording = 1;
}

static void on_start(unsigned cpu, void *user)
{
    function_t *f = user;
    (void)cpu;
    if (!recording || f->open) { /* no function of the firmware calls itself */
        return;
    }
    if (depth == DEPTH_MAX) {
        fprintf(stderr, "count plugin: calls nested deeper than %d\n", DEPTH_MAX);
        abort();
    }
    f->at_start = counted();
    f->nested = 0;
    f->open = 1;
    calls[depth++] = f;
}

static void end_innermost(void)
{
    function_t *f = calls[--depth];
    const uint64_t count = counted() - f->at_start;
    fprintf(out, "%s %" PRIu64 " %" PRIu64 "\n", f->name, count, count - f->nested);
    f->open = 0;
    if (depth > 0) {
        calls[depth - 1]->nested += count;
    }
}

/* A function that was left by a jump into another one ends with it. */
static void on_end(unsigned cpu, void *user)
{
    function_t *f = user;
    (void)cpu;
    while (f->open) {
        end_innermost();
    }
}

/* The callbacks come before the in-line counter of the same instruction, so both ends see the count
 * before it. */
static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    for (size_t i = 0; i < qemu_plugin_tb_n_insns(tb); i++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        const uint64_t address = qemu_plugin_insn_vaddr(insn);
        if (address == from_address) {
            qemu_plugin_register_vcpu_insn_exec_cb(insn, on_from, QEMU_PLUGIN_CB_NO_REGS, NULL);
        }
        for (int k = 0; k < function_count; k++) {
            function_t *f = &functions[k];
            for (int e = 0; e < f->ends; e++) {
                if (address == f->end[e]) {
                    qemu_plugin_register_vcpu_insn_exec_cb(insn, on_end, QEMU_PLUGIN_CB_NO_REGS, f);
                }
            }
            if (address == f->start) {
                qemu_plugin_register_vcpu_insn_exec_cb(insn, on_start, QEMU_PLUGIN_CB_NO_REGS, f);
            }
        }
        count_this(insn);
    }
}

static void on_exit_of_emulator(qemu_plugin_id_t id, void *user)
{
    (void)id;
    (void)user;
    if (out != NULL) {
        fclose(out);
    }
}

static int add_function(char *text)
{
    if (function_count == FUNCTIONS_MAX) {
        return -1;
    }
    function_t *f = &functions[function_count++];
    char *part = strtok(text, ":");
    if (part == NULL || strlen(part) >= sizeof f->name) {
        return -1;
    }
    strcpy(f->name, part);
    part = strtok(NULL, ":");
    if (part == NULL) {
        return -1;
    }
    f->start = strtoull(part, NULL, 0);
    while ((part = strtok(NULL, ":")) != NULL) {
        if (f->ends == ENDS_MAX) {
            return -1;
        }
        f->end[f->ends++] = strtoull(part, NULL, 0);
    }
    return f->ends > 0 ? 0 : -1;
}

int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        int bad = 0;
        if (strncmp(argv[i], "out=", 4) == 0) {
            out = fopen(argv[i] + 4, "w");
            bad = out == NULL;
        } else if (strncmp(argv[i], "from=", 5) == 0) {
            from_address = strtoull(argv[i] + 5, NULL, 0);
        } else if (strncmp(argv[i], "fn=", 3) == 0) {
            bad = add_function(argv[i] + 3);
        } else {
            bad = 1;
        }
        if (bad) {
            fprintf(stderr, "count plugin: cannot use %s\n", argv[i]);
            return -1;
        }
    }
    prepare_counter();
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    qemu_plugin_register_atexit_cb(id, on_exit_of_emulator, NULL);
    return 0;
}
