#include "warp/app/help_format.h"

#include <fmt/format.h>

#include <algorithm>

namespace eikonal {
namespace {

constexpr std::size_t kNameWidth = 32;

/// Number of columns that a text takes on a terminal: its number of code points.
std::size_t columns(std::string_view text) {
    std::size_t count = 0;
    for (const char c : text) count += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    return count;
}

/// One entry of the help, "  name      text". The text is wrapped in its own column. It begins on a new line if the
/// name is long.
std::string entry(const std::string& name, const std::string& text) {
    std::string out = "  " + name;
    std::size_t at = 2 + columns(name);
    const auto new_line = [&] {
        out += '\n' + std::string(kNameWidth, ' ');
        at = kNameWidth;
    };
    if (at + 1 > kNameWidth) new_line();
    out.append(kNameWidth - at, ' ');
    at = kNameWidth;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        if (at > kNameWidth && at + 1 + columns(word) > kHelpWidth) new_line();
        if (at > kNameWidth) {
            out += ' ';
            ++at;
        }
        out += word;
        at += columns(word);
        begin = end + 1;
    }
    return out + '\n';
}

std::string name_of(const CLI::Option* option) {
    std::string name = option->get_positional() ? option->get_name(true) : "";
    for (const std::string& s : option->get_snames()) name += (name.empty() ? "-" : ", -") + s;
    for (const std::string& l : option->get_lnames()) name += (name.empty() ? "--" : ", --") + l;
    if (!option->get_positional() && option->get_type_size() != 0) name += " " + option->get_type_name();
    return name;
}

}  // namespace

std::string HelpFormat::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
    std::string usage, files;
    const auto commands = app->get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::Option* option : app->get_options()) {
        if (!option->get_required()) continue;
        usage += option->get_positional()
                     ? " " + option->get_name(true)
                     : fmt::format(" -{} {}", option->get_snames().front(), option->get_type_name());
    }
    const std::string called =
        app->get_parent() == nullptr ? app->get_name() : app->get_parent()->get_name() + " " + app->get_name();
    std::string text = app->get_description() +
                       fmt::format("\n\nUsage: {}{}{} [options]\n", called, usage, commands.empty() ? "" : " COMMAND");
    if (!commands.empty()) text += "\nCommands:\n";
    for (const CLI::App* command : commands)
        text += entry(command->get_name(), command->get_description().substr(0, command->get_description().find('\n')));
    std::vector<std::string> groups = app->get_groups();
    std::rotate(groups.begin(), std::find(groups.begin(), groups.end(), "Files"), groups.end());  // --help goes last
    for (const std::string& group : groups) {
        std::string entries;
        for (const CLI::Option* option : app->get_options())
            if (option->get_group() == group) entries += entry(name_of(option), option->get_description());
        if (!entries.empty()) text += fmt::format("\n{}:\n{}", group, entries);
    }
    return app->get_footer().empty() ? text : text + "\n" + app->get_footer() + "\n";
}

}  // namespace eikonal
