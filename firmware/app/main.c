/* SPDX-License-Identifier: Apache-2.0 */
#include "app/app.h"
#include "hal/time.h"

int main(void)
{
    app_boot();
    while (time_running()) {
        app_background();
    }
    return app_finish() ? 0 : 1;
}
