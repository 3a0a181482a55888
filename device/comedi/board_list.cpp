#include "device/comedi/board_list.h"

#include <comedilib.h>

#include <filesystem>

#include "device/comedi/boards.h"
#include "models/errors.h"

namespace handloop::device::comedi {

std::vector<BoardInfo> list_boards() {
  constexpr int kMinors = 16;
  std::vector<BoardInfo> boards;
  for (int minor = 0; minor < kMinors; ++minor) {
    BoardInfo info;
    info.path = "/dev/comedi" + std::to_string(minor);
    std::error_code ignored;
    if (!std::filesystem::exists(info.path, ignored)) continue;
    try {
      const Board board = open_board(info.path);
      info.name = comedi_get_board_name(board.get());
      for (int i = 0; i < comedi_get_n_subdevices(board.get()); ++i) {
        const auto subdevice = static_cast<unsigned>(i);
        const int channels = comedi_get_n_channels(board.get(), subdevice);
        const int type = comedi_get_subdevice_type(board.get(), subdevice);
        if (type == COMEDI_SUBD_COUNTER) ++info.counters;
        if (type == COMEDI_SUBD_AI) info.analog_inputs += channels;
        if (type == COMEDI_SUBD_AO) info.analog_outputs += channels;
      }
    } catch (const InputError& error) {
      info.problem = error.what();
    }
    boards.push_back(std::move(info));
  }
  return boards;
}

}  // namespace handloop::device::comedi
