// KeyFilter: content filters by a text member ("STATION in these names"), as a filter class of our own,
// because the
// SQL filter needs a type object, which our types do not have.
// Private to dds_bridge; the factory is owned by the bus and outlives its participant's entities.
// Called from the library's threads: nothing here throws or keeps state.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dds_bridge/compat.hpp"
#include "dds_bridge/type_table.hpp"

namespace stationd::bus {

/// Name of the filter class, as it is announced to writers (which then filter at their side if they know it).
inline constexpr const char* kKeyFilterClass = "stationd.key";

/// The expression for `count` names: "STATION in (%0, %1)".
std::string key_filter_expression(std::string_view member, std::size_t count);
/// Names as parameters: quoted, as in SQL.
std::vector<std::string> key_filter_parameters(const std::vector<std::string>& names);

class KeyFilterFactory final : public compat::ContentFilterFactory {
 public:
  compat::ReturnCode_t create_content_filter(const char* filter_class_name, const char* type_name,
                                             const compat::dds::TopicDataType* data_type,
                                             const char* filter_expression,
                                             const ParameterSeq& filter_parameters,
                                             compat::dds::IContentFilter*& filter_instance) override;
  compat::ReturnCode_t delete_content_filter(const char* filter_class_name,
                                             compat::dds::IContentFilter* filter_instance) override;
};

}  // namespace stationd::bus
