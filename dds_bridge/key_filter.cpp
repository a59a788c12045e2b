#include "dds_bridge/key_filter.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>

#include "dds_bridge/topic_type.hpp"

namespace stationd::bus {
namespace {

class KeyFilter final : public compat::ContentFilter {
 public:
  KeyFilter(const TypeTable& table, std::string member, std::vector<std::string> names)
      : table_(table), member_(std::move(member)), names_(std::move(names)) {}

  /// A sample that cannot be read passes, so that it is counted where samples are taken.
  bool evaluate(const SerializedPayload& payload, const FilterSampleInfo&, const GUID_t&) const override {
    const PayloadUse use(payload);
    const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(payload.data), payload.length);
    const auto value = peek_text(table_, member_, bytes);
    return !value || std::ranges::find(names_, *value) != names_.end();
  }

 private:
  const TypeTable& table_;
  std::string member_;
  std::vector<std::string> names_;
};

}  // namespace

std::string key_filter_expression(std::string_view member, std::size_t count) {
  std::string expression(member);
  expression += " in (";
  for (std::size_t i = 0; i < count; ++i) expression.append(i == 0 ? "%" : ", %").append(std::to_string(i));
  return expression + ")";
}

std::vector<std::string> key_filter_parameters(const std::vector<std::string>& names) {
  std::vector<std::string> parameters;
  for (const std::string& name : names) parameters.push_back("'" + name + "'");
  return parameters;
}

compat::ReturnCode_t KeyFilterFactory::create_content_filter(const char*, const char*,
                                                             const compat::dds::TopicDataType* data_type,
                                                             const char* filter_expression,
                                                             const ParameterSeq& filter_parameters,
                                                             compat::dds::IContentFilter*& filter_instance) {
  const auto* type = dynamic_cast<const TopicType*>(data_type);
  if (type == nullptr) return compat::return_code(compat::kError);
  std::string member;
  if (filter_expression != nullptr) {  // null: only the parameters of an existing filter change
    const std::string_view expression(filter_expression);
    member = expression.substr(0, expression.find(' '));
  } else {
    member = type->table().find("STATION") != nullptr ? "STATION" : "DEST_STATION";
  }
  const Member* found = type->table().find(member);
  if (found == nullptr || found->kind != Kind::text) return compat::return_code(compat::kError);
  std::vector<std::string> names;
  for (compat::dds::LoanableCollection::size_type i = 0; i < filter_parameters.length(); ++i) {
    const std::string_view quoted(filter_parameters[i]);
    if (quoted.size() < 2) return compat::return_code(compat::kError);
    names.emplace_back(quoted.substr(1, quoted.size() - 2));
  }
  delete static_cast<KeyFilter*>(filter_instance);
  filter_instance = std::make_unique<KeyFilter>(type->table(), std::move(member), std::move(names)).release();
  return compat::return_code(compat::kOk);
}

compat::ReturnCode_t KeyFilterFactory::delete_content_filter(const char*,
                                                             compat::dds::IContentFilter* filter_instance) {
  delete static_cast<KeyFilter*>(filter_instance);
  return compat::return_code(compat::kOk);
}

}  // namespace stationd::bus
