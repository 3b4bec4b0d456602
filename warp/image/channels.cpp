#include "warp/image/channels.h"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace eikonal {
namespace {

using OIIO::TypeDesc;

constexpr std::array kDataWords = {
    "depth",      "zdepth",    "deep",       "normal",        "normals", "position",    "positions", "pos",
    "pworld",     "pref",      "worldpos",   "worldposition", "uv",      "uvs",         "uvw",       "st",
    "stmap",      "motion",    "velocity",   "motionvector",  "vector",  "vectors",     "mv",        "mvec",
    "flow",       "disparity", "forward",    "backward",      "id",      "ids",         "objectid",  "objid",
    "materialid", "matid",     "assetid",    "instanceid",    "crypto",  "cryptomatte", "mask",      "masks",
    "matte",      "mattes",    "multimatte", "displacement"};

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/// Lower-case words without digits: "ObjectID_01" -> object, id.
std::vector<std::string> words_of(std::string_view name) {
    std::vector<std::string> words(1);
    char before = ' ';
    for (const char c : name) {
        const auto u = static_cast<unsigned char>(c);
        const bool starts = std::isupper(u) && std::islower(static_cast<unsigned char>(before));
        if (!words.back().empty() && (starts || !std::isalpha(u))) words.emplace_back();
        if (std::isalpha(u)) words.back() += static_cast<char>(std::tolower(u));
        before = c;
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

bool is_data_name(std::string_view name) {
    const std::vector<std::string> words = words_of(name);
    const auto known = [](const std::string& word) {
        return std::find(kDataWords.begin(), kDataWords.end(), word) != kDataWords.end();
    };
    if (std::any_of(words.begin(), words.end(), known)) return true;
    return words.size() == 1 && (words[0] == "n" || words[0] == "p" || words[0] == "z");
}

/// Layer names that a cryptomatte header lists: attributes cryptomatte/HASH/name.
std::vector<std::string> cryptomatte_layers(const OIIO::ImageSpec& spec) {
    std::vector<std::string> layers;
    for (const auto& attribute : spec.extra_attribs) {
        const OIIO::string_view name(attribute.name());
        if (OIIO::Strutil::istarts_with(name, "cryptomatte/") && OIIO::Strutil::iends_with(name, "/name"))
            layers.push_back(attribute.get_string());
    }
    return layers;
}

struct Name {
    std::string layer;    ///< as written, without the dot
    std::string channel;  ///< lower case
};

Name split(const std::string& full) {
    const std::size_t dot = full.rfind('.');
    if (dot == std::string::npos) return {"", lower(full)};
    return {full.substr(0, dot), lower(std::string_view(full).substr(dot + 1))};
}

/// Place of a colour channel in its group: R, G, B, then the others. -1 if the name is not that of a colour.
int colour_rank(const std::string& channel, bool layer_has_x) {
    if (channel == "r" || channel == "red") return 0;
    if (channel == "g" || channel == "green") return 1;
    if (channel == "b" || channel == "blue") return 2;
    const bool grey =
        channel == "y" || channel == "luminance" || channel == "i" || channel == "gray" || channel == "grey";
    return grey && !layer_has_x ? 3 : -1;
}

bool wide_integer(TypeDesc type) {
    return type.basetype == TypeDesc::UINT32 || type.basetype == TypeDesc::INT32 || type.basetype == TypeDesc::UINT64 ||
           type.basetype == TypeDesc::INT64;
}

/// The colour channels of one layer, and its alpha.
struct Layer {
    struct Member {
        int rank;
        int channel;
    };
    std::vector<Member> colours;
    int alpha = -1;
};

/// Appends the groups of a layer: its colours, sorted by rank, three at a time. A layer of alpha alone is one group.
void add_groups(const std::string& name, Layer& layer, std::vector<ChannelGroup>& groups) {
    std::stable_sort(layer.colours.begin(), layer.colours.end(),
                     [](const Layer::Member& a, const Layer::Member& b) { return a.rank < b.rank; });
    for (std::size_t first = 0; first == 0 || first < layer.colours.size(); first += 3) {
        ChannelGroup group;
        group.layer = name;
        group.alpha = layer.alpha;
        for (std::size_t i = first; i < std::min(first + 3, layer.colours.size()); ++i)
            group.channel[static_cast<std::size_t>(group.count++)] = layer.colours[i].channel;
        groups.push_back(group);
    }
}

}  // namespace

void classify_channels(Part& part, std::string_view format) {
    const OIIO::ImageSpec& spec = part.spec;
    const auto count = static_cast<std::size_t>(spec.nchannels);
    const std::string part_name = spec.get_string_attribute("name", spec.get_string_attribute("oiio:subimagename"));
    const std::vector<std::string> crypto = cryptomatte_layers(spec);
    const bool plain = format != "openexr" && !spec.format.is_floating_point() && count <= 4;

    std::vector<Name> names;
    std::map<std::string, bool> has_x;
    for (std::size_t c = 0; c < count; ++c) {
        names.push_back(split(spec.channel_name(static_cast<int>(c))));
        if (names[c].channel == "x") has_x[names[c].layer] = true;
    }

    std::map<std::string, Layer> layers;
    std::vector<std::string> order;  // the layers in the order of their first appearance

    part.kinds.assign(count, ChannelKind::Data);
    for (std::size_t c = 0; c < count; ++c) {
        const auto& [layer, channel] = names[c];
        const int index = static_cast<int>(c);
        const std::string& called = layer.empty() ? part_name : layer;
        const bool crypted = std::any_of(crypto.begin(), crypto.end(), [&](const std::string& prefix) {
            return !prefix.empty() && called.compare(0, prefix.size(), prefix) == 0;
        });
        if (wide_integer(spec.channelformat(index)) || index == spec.z_channel || crypted || is_data_name(called))
            continue;
        int rank = colour_rank(channel, has_x[layer]);
        const bool alpha = channel == "a" || channel == "alpha" || index == spec.alpha_channel;
        if (rank < 0 && plain && !alpha && !is_data_name(channel)) rank = 4;
        if (rank < 0 && !alpha) continue;

        if (!layers.contains(layer)) order.push_back(layer);
        Layer& members = layers[layer];
        if (alpha && members.alpha < 0) {
            part.kinds[c] = ChannelKind::Alpha;
            members.alpha = index;
        } else {
            part.kinds[c] = ChannelKind::Colour;
            members.colours.push_back({alpha ? 5 : rank, index});
        }
    }

    part.groups.clear();
    for (const std::string& name : order) add_groups(name, layers[name], part.groups);
    // The main layer first.
    std::stable_partition(part.groups.begin(), part.groups.end(),
                          [](const ChannelGroup& group) { return group.layer.empty(); });
}

Transfer transfer_of(const OIIO::ImageSpec& spec, std::string_view format) {
    std::string space;
    for (const char c : lower(std::string(spec.get_string_attribute("oiio:ColorSpace"))))
        if (c != '_' && c != ' ' && c != '-') space += c;
    const auto starts = [&](std::string_view prefix) { return space.compare(0, prefix.size(), prefix) == 0; };
    if (starts("lin") || starts("scenelin") || starts("aces") || space == "raw" || space == "data")
        return Transfer::Linear;
    if (starts("srgb")) return Transfer::SRGB;
    const bool linear_floats =
        format == "pnm" && spec.format.is_floating_point();  // PFM, which OpenImageIO calls Rec709
    if ((starts("rec709") || starts("bt709")) && !linear_floats) return Transfer::BT709;
    if (starts("kodaklog") || starts("cineon")) return Transfer::KodakLog;
    if (starts("adobergb")) return Transfer::Gamma22;
    if (starts("gamma")) {
        const float named = OIIO::Strutil::from_string<float>(space.substr(5));
        const float gamma = named > 0 ? named : spec.get_float_attribute("oiio:Gamma", 2.2f);
        return std::fabs(gamma - 1) < 0.02f ? Transfer::Linear : Transfer::Gamma22;
    }
    return spec.format.is_floating_point() ? Transfer::Linear : Transfer::SRGB;
}

}  // namespace eikonal
