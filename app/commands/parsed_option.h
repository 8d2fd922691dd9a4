// An option whose text is made a value of as the command line is read, so that wrong use is told then.
#pragma once

#include <string>

#include "app/commands/option_set.h"

namespace spoonbill {

// `parse` makes a Result of the text, `take` keeps its value; the form is what --help shows for it.
template <class Parse, class Take>
CommandOption add_parsed_option(OptionSet parser, const std::string& name, const char* form,
                                const Parse& parse, const Take& take, const std::string& help) {
  return parser
      .add_parsed(
          name,
          [=](const std::string& text) -> Status {
            auto value = parse(text);
            if (!value) return value.error();
            take(value.value());
            return {};
          },
          help)
      .show_as(form);
}

}  // namespace spoonbill
