/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What newlib asks of an operating system, for test programs that use malloc or printf. Output goes
 * to semihosting; there are no files and no other processes.
 */
#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

#include "semihost.h"

enum { HEAP_BYTES = 1 << 20 };

/* newlib calls these by name and declares them nowhere. */
void *_sbrk(ptrdiff_t increment);
int _write(int file, const char *bytes, int size);
int _read(int file, char *bytes, int size);
int _close(int file);
int _fstat(int file, struct stat *status);
int _isatty(int file);
int _lseek(int file, int offset, int whence);
int _getpid(void);
int _kill(int process, int signal);
_Noreturn void _exit(int status);
void target_putchar(int character);

void target_putchar(int character)
{
    const char text[2] = {(char)character, '\0'};
    semihost_print(text);
}

void *_sbrk(ptrdiff_t increment)
{
    static _Alignas(8) char heap[HEAP_BYTES];
    static ptrdiff_t used;
    if (used + increment > HEAP_BYTES) {
        errno = ENOMEM;
        return (void *)-1; /* NOLINT: what the function must return */
    }
    used += increment;
    return &heap[used - increment];
}

int _write(int file, const char *bytes, int size)
{
    (void)file;
    for (int i = 0; i < size; i++) {
        target_putchar(bytes[i]);
    }
    return size;
}

int _read(int file, char *bytes, int size)
{
    (void)file;
    (void)bytes;
    (void)size;
    return 0;
}

int _close(int file)
{
    (void)file;
    return 0;
}

int _fstat(int file, struct stat *status)
{
    (void)file;
    status->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file)
{
    (void)file;
    return 1;
}

int _lseek(int file, int offset, int whence)
{
    (void)file;
    (void)offset;
    (void)whence;
    return 0;
}

int _getpid(void)
{
    return 1;
}

int _kill(int process, int signal)
{
    (void)process;
    (void)signal;
    errno = EINVAL;
    return -1;
}

_Noreturn void _exit(int status)
{
    semihost_exit(status == 0);
}
