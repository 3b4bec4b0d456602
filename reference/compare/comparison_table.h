/// The figures of a comparison as columns: one list, from which the CSV, the text and the page are made.
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
    std::string key;                                                        ///< in the CSV
    std::string heading;                                                    ///< for people, with its unit
    bool brief;                                                             ///< part of the page's first table
    std::optional<double> (*value)(const Comparison&, const ModelResult&);  ///< none: there is no such figure
};

/// Every column that the comparison has figures for, in order.
std::vector<Column> columns(const Comparison& comparison);
std::string heading_of(ColumnGroup group);

/// Three significant digits, without exponents where that is readable; "∞".
std::string readable(double value);
/// Name of a model's row, and whether it is the default.
std::string row_name(const ModelResult& model);

/// What the scene is: label and text, in order.
struct Fact {
    std::string label, text;
};
std::vector<Fact> facts(const Comparison& comparison);

/// "model,default,KEY,…", a row for each model that applies; figures that there are none of, or that are
/// infinite, are empty.
std::string table_csv(const Comparison& comparison);
/// Facts, a table for each group of columns, and the models that do not apply, with the reason.
std::string table_text(const Comparison& comparison);

}  // namespace eikonal::reference
