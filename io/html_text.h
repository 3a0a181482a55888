#pragma once

#include <string>
#include <string_view>

namespace handloop::io {

/// The text with the characters that mean something in HTML replaced; control characters become blanks.
std::string escape_html(std::string_view text);

/// Escaped text in which `code`, **strong** and [words](\#place or https://...) are marked up.
std::string markup_to_html(std::string_view text);

}  // namespace handloop::io
