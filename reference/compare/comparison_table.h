/// The figures of a comparison as one list of columns. The CSV, the text and the page are made from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/compare/comparison.h"

namespace eikonal::reference {

/// Columns that belong together.
enum class ColumnGroup { All, Smooth, Silhouettes, Temporal, Picture, Cost };

struct Column {
    ColumnGroup group;
    std::string key;                                                        ///< name in the CSV
    std::string heading;                                                    ///< for people, with its unit
    bool brief;                                                             ///< part of the page's first table
    std::optional<double> (*value)(const Comparison&, const ModelResult&);  ///< nothing if there is no such figure
};

/// Every column that the comparison has figures for, in order.
std::vector<Column> columns(const Comparison& comparison);
std::string heading_of(ColumnGroup group);

/// A number with three significant digits, without an exponent where that is readable. "∞" for infinity.
std::string readable(double value);
/// Name of a model's row, and whether it is the default.
std::string row_name(const ModelResult& model);

/// Facts about the scene in order, each with a label.
struct Fact {
    std::string label, text;
};
std::vector<Fact> facts(const Comparison& comparison);

/// A CSV with the header "model,default,KEY,…" and a row for each model that applies. A figure that does not exist or
/// is infinite is empty.
std::string table_csv(const Comparison& comparison);
/// Text with the facts, a table for each group of columns, and the models that do not apply, with the reason.
std::string table_text(const Comparison& comparison);

}  // namespace eikonal::reference
