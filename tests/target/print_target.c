#include "print.h"

#include "semihost.h"

void print(const char *text)
{
    semihost_print(text);
}
