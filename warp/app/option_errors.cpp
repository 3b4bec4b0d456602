#include "warp/app/option_errors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "noise/base/error.h"
#include "warp/scene/message.h"

namespace eikonal {

std::string suggestion(std::string_view word, const std::vector<std::string>& valid, const std::string& otherwise) {
    const std::vector<std::string_view> views(valid.begin(), valid.end());
    const std::string meant = scene_file::did_you_mean(word, views);
    return meant.empty() ? otherwise : meant;
}

void rephrase(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& words) {
    const CLI::App* at = &app;
    for (const CLI::App* sub : app.get_subcommands()) at = sub;
    std::vector<std::string> valid;
    for (const CLI::Option* option : at->get_options())
        for (const auto& name : option->get_lnames()) valid.push_back("--" + name);
    std::vector<std::string> commands;
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
        commands.push_back(sub->get_name());
    if (at == &app && (words.empty() || words.front().rfind('-', 0) != 0)) {
        if (words.empty()) throw UserError(fmt::format("no command given; one of {}", fmt::join(commands, ", ")));
        throw UserError(fmt::format("'{}' is no command; one of {}{}", words.front(), fmt::join(commands, ", "),
                                    suggestion(words.front(), commands)));
    }
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
        for (const std::string& word : at->remaining(true)) {
            const std::string name = word.substr(0, word.find('='));
            if (name.rfind("--", 0) == 0)
                throw UserError(fmt::format("{}: '{}' has no such option{}", name, at->get_name(),
                                            suggestion(name, valid, "; see --help")));
            throw UserError(fmt::format("'{}': too many arguments for '{}'; see --help", word, at->get_name()));
        }
    std::string text = error.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
        text = text.substr(0, text.find(':')) + (text.find("At Most") != std::string::npos
                                                     ? ": is given more than once; give it once"
                                                     : ": its value is missing");
    throw UserError(fmt::format("{}; see 'eikonal {} --help'", text, at == &app ? "" : at->get_name()));
}

}  // namespace eikonal
