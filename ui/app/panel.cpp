#include "ui/app/panel.h"

#include "io/output.h"
#include "models/errors.h"
#include "ui/app/app.h"

namespace handloop::ui {

void run_panel(const PanelOptions& options) {
  if (options.screenshot && options.frames < 1) throw InputError("panel: --frames: give one or more");
  if (options.scale != 0.0 && !(options.scale >= 1.0 && options.scale <= 2.0))
    throw InputError("panel: --scale: give a number from 1 to 2");
  if (options.width < 640 || options.height < 400 || options.width > 8192 || options.height > 8192)
    throw InputError("panel: --size: give from 640x400 to 8192x8192");
  if (options.scenario.device.model != models::DeviceModel::phantom_premium_1_5)
    throw InputError("panel: device.model: the panel tunes phantom_premium_1_5 only");
  App app(options);
  app.run();
}

}  // namespace handloop::ui
