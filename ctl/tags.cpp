// get, force, unforce and set: single tags of a station (RR).
#include <string>
#include <vector>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "ctl/replies.hpp"
#include "ctl/requests.hpp"
#include "ctl/tags_text.hpp"
#include "dds_bridge/text.hpp"

namespace stationd::ctl {
namespace {

int change(const Arguments& arguments, const std::string& verb) {
  return ask_and_show(arguments, verb + " " + arguments.text, [&](const std::string& body) {
    return bus::printable(arguments.station) + ": " + bus::printable(change_text(body));
  });
}

}  // namespace

int force(const Arguments& arguments) { return change(arguments, "force"); }

int unforce(const Arguments& arguments) { return change(arguments, "unforce"); }

int set(const Arguments& arguments) { return change(arguments, "set"); }

int get(const Arguments& arguments) {
  Client client(arguments);
  std::vector<Pairs> rows;
  std::string request = "tags" + (arguments.text.empty() ? "" : " " + arguments.text);
  while (!request.empty()) {
    const auto reply = ask(client, arguments, request);
    if (!reply) return fail_unanswered(arguments, client);
    if (reply->ERROR) return show(arguments, *reply, {});
    TagRows piece = tag_rows(without_id(reply->BODY));
    const bool goes_on = !piece.next.empty() && !piece.rows.empty();
    request = goes_on ? "tags after " + piece.next : "";
    for (Pairs& row : piece.rows) rows.push_back(std::move(row));
  }
  if (arguments.json) {
    print_line(tags_json(arguments.station, rows));
  } else {
    for (const std::string& line : tags_table(rows)) print_line(line);
  }
  return kDone;
}

}  // namespace stationd::ctl
