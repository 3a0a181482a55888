#include "io/json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/output.h"

namespace handloop::io {

nlohmann::ordered_json json_number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

void write_json(const nlohmann::ordered_json& json, const std::string& target) {
  // Text from files may not be UTF-8: replaced rather than refused, it is a label.
  write_file_atomically(target, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace handloop::io
