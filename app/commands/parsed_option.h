// An option whose text is made a value of as the command line is read, so that wrong use is told then.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

namespace spoonbill {

// `parse` makes a Result of the text, `take` keeps its value; the form is what --help shows for it.
template <class Parse, class Take>
CLI::Option* add_parsed_option(CLI::App& parser, const std::string& name, const char* form,
                               const Parse& parse, const Take& take, const std::string& help) {
  return parser
      .add_option_function<std::string>(
          name,
          [=](const std::string& text) {
            auto value = parse(text);
            if (!value) throw CLI::ValidationError(name, value.error().message);
            take(value.value());
          },
          help)
      ->type_name(form);
}

}  // namespace spoonbill
