// A foreign peer: Cyclone DDS and the paper's literal Table 4, nothing of stationd's.
// A program of its own, started by bus_interop_test and by scripts; exit status 0 if all went as asked within
// 30 s.
// One thread.
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <table4.h>  // made by idlc

#define LIMIT DDS_SECS(30)
#define PAUSE DDS_MSECS(10)

static dds_entity_t participant, publisher, subscriber;

static void fail(const char* what, dds_return_t code) {
  fprintf(stderr, "cyclone_peer: %s: %s\n", what, dds_strretcode(-code));
  exit(1);
}

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) fail(what, entity);
  return entity;
}

static void join(int domain, const char* cell) {
  const char* partitions[] = {cell};
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition(qos, 1, partitions);
  participant = checked(dds_create_participant((dds_domainid_t)domain, NULL, NULL), "participant");
  publisher = checked(dds_create_publisher(participant, qos, NULL), "publisher");
  subscriber = checked(dds_create_subscriber(participant, qos, NULL), "subscriber");
  dds_delete_qos(qos);
}

static dds_entity_t topic(const dds_topic_descriptor_t* type, const char* name) {
  return checked(dds_create_topic(participant, type, name, NULL, NULL), name);
}

static dds_qos_t* reliable(int depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  if (depth > 0)
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
  else
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  return qos;
}

// Set, End and GSE, `count` of each, one line each.
static int listen_to(int count) {
  dds_qos_t* durable = reliable(0);
  dds_qset_durability(durable, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_entity_t set =
      checked(dds_create_reader(subscriber, topic(&PV_Set_desc, "Set"), NULL, NULL), "Set reader");
  const dds_entity_t end =
      checked(dds_create_reader(subscriber, topic(&PV_End_desc, "End"), NULL, NULL), "End reader");
  const dds_entity_t gse =
      checked(dds_create_reader(subscriber, topic(&ASE_GSE_desc, "GSE"), durable, NULL), "GSE reader");
  dds_delete_qos(durable);
  int sets = 0, ends = 0, events = 0;
  for (const dds_time_t until = dds_time() + LIMIT; dds_time() < until; dds_sleepfor(PAUSE)) {
    void* sample[1] = {NULL};
    dds_sample_info_t info;
    while (sets < count && dds_take(set, sample, &info, 1, 1) > 0) {
      const PV_Set* m = sample[0];
      if (info.valid_data && ++sets) printf("Set %s %u\n", m->STATION, m->CODE);
      dds_return_loan(set, sample, 1);
    }
    while (ends < count && dds_take(end, sample, &info, 1, 1) > 0) {
      const PV_End* m = sample[0];
      if (info.valid_data && ++ends) printf("End %s %u %d %u\n", m->STATION, m->CODE, m->ERROR, m->STATUS);
      dds_return_loan(end, sample, 1);
    }
    while (events < count && dds_take(gse, sample, &info, 1, 1) > 0) {
      const ASE_GSE* m = sample[0];
      if (info.valid_data && ++events) printf("GSE %d %u\n", m->ERROR, m->STATUS);
      dds_return_loan(gse, sample, 1);
    }
    if (sets >= count && ends >= count && events >= count) return 0;
  }
  fprintf(stderr, "cyclone_peer: only %d Set, %d End, %d GSE\n", sets, ends, events);
  return 1;
}

// Announces as a station would, with Cyclone's own default QoS, for some seconds.
static int say(const char* station, unsigned code, int seconds) {
  const dds_entity_t set =
      checked(dds_create_writer(publisher, topic(&PV_Set_desc, "Set"), NULL, NULL), "Set writer");
  const dds_entity_t end =
      checked(dds_create_writer(publisher, topic(&PV_End_desc, "End"), NULL, NULL), "End writer");
  PV_Set s = {(char*)station, code};
  PV_End e = {(char*)station, code, true, 4711};
  for (const dds_time_t until = dds_time() + DDS_SECS(seconds); dds_time() < until; dds_sleepfor(PAUSE)) {
    dds_return_t code_set = dds_write(set, &s), code_end = dds_write(end, &e);
    if (code_set < 0) fail("write Set", code_set);
    if (code_end < 0) fail("write End", code_end);
  }
  return 0;
}

// How many peers there are to match: in a cell of several controllers the one that is meant may be the last.
static uint32_t peers(void) {
  const char* text = getenv("CYCLONE_PEER_MATCHES");
  return text == NULL ? 1 : (uint32_t)strtoul(text, NULL, 10);
}

static void await_match(dds_entity_t writer, dds_entity_t reader) {
  for (const dds_time_t until = dds_time() + LIMIT; dds_time() < until; dds_sleepfor(PAUSE)) {
    dds_publication_matched_status_t out;
    dds_subscription_matched_status_t in = {0};
    dds_get_publication_matched_status(writer, &out);
    if (reader != 0) dds_get_subscription_matched_status(reader, &in);
    if (out.current_count >= peers() && (reader == 0 || in.current_count >= peers())) return;
  }
  fprintf(stderr, "cyclone_peer: nobody reads\n");
  exit(1);
}

static int await_reply(dds_entity_t reader, const char* id) {
  for (const dds_time_t until = dds_time() + LIMIT; dds_time() < until; dds_sleepfor(PAUSE)) {
    void* sample[1] = {NULL};
    dds_sample_info_t info;
    while (dds_take(reader, sample, &info, 1, 1) > 0) {
      const Msg_Res* m = sample[0];
      const bool mine = info.valid_data && strncmp(m->BODY, id, strlen(id)) == 0;
      if (mine) printf("Msg_Res %s %u %d %u %s\n", m->DEST_STATION, m->CODE, m->ERROR, m->STATUS, m->BODY);
      dds_return_loan(reader, sample, 1);
      if (mine) return 0;
    }
  }
  fprintf(stderr, "cyclone_peer: no reply\n");
  return 1;
}

// One Start, Stop or Msg; of the last, prints the answer.
static int order(const char* kind, const char* station, const char* body) {
  const bool msg = strcmp(kind, "Msg") == 0;
  dds_qos_t* qos = reliable(64);
  dds_entity_t replies = 0;
  if (msg) {
    replies =
        checked(dds_create_reader(subscriber, topic(&Msg_Res_desc, "Msg_Res"), qos, NULL), "Msg_Res reader");
  }
  const dds_entity_t writer = checked(
      dds_create_writer(publisher, topic(&Msg_Req_desc, msg ? "Msg_Req" : kind), qos, NULL), "writer");
  dds_delete_qos(qos);
  await_match(writer, replies);
  char text[1024];
  snprintf(text, sizeof(text), "%s from=cyclone id=77", body);
  const Order_t which = msg ? MSG : strcmp(kind, "Stop") == 0 ? STOP : START;
  Msg_Req request = {(char*)station, text, which};
  const dds_return_t code = dds_write(writer, &request);
  if (code < 0) fail("write", code);
  if (msg) return await_reply(replies, "id=77 ");
  return dds_wait_for_acks(writer, LIMIT) == 0 ? 0 : 1;
}

static void print_duration(const char* name, bool there, dds_duration_t value) {
  if (there && value != DDS_INFINITY)
    printf(" %s=%lldms", name, (long long)(value / DDS_MSECS(1)));
  else
    printf(" %s=none", name);
}

// What an endpoint of others announces of its QoS, one line.
static void print_endpoint(const char* what, const dds_builtintopic_endpoint_t* m) {
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
  dds_duration_t deadline = DDS_INFINITY, lease = DDS_INFINITY, budget = 0, blocking = 0;
  int32_t priority = 0;
  uint32_t count = 0;
  char** partitions = NULL;
  dds_qget_reliability(m->qos, &reliability, &blocking);
  dds_qget_durability(m->qos, &durability);
  const bool has_deadline = dds_qget_deadline(m->qos, &deadline);
  const bool has_lease = dds_qget_liveliness(m->qos, &liveliness, &lease);
  dds_qget_latency_budget(m->qos, &budget);
  dds_qget_transport_priority(m->qos, &priority);
  dds_qget_partition(m->qos, &count, &partitions);
  printf("%s %s %s %s %s", what, m->topic_name, m->type_name,
         reliability == DDS_RELIABILITY_RELIABLE ? "reliable" : "best-effort",
         durability == DDS_DURABILITY_TRANSIENT_LOCAL ? "transient-local" : "volatile");
  print_duration("deadline", has_deadline, deadline);
  print_duration("lease", has_lease, lease);
  print_duration("budget", true, budget);
  printf(" priority=%d partition=%s\n", priority, count > 0 ? partitions[0] : "");
  for (uint32_t i = 0; i < count; i++) dds_free(partitions[i]);
  dds_free(partitions);
}

// The QoS that the others' endpoints announce, until `count` of them have been seen.
static int list_qos(int count) {
  const struct {
    const char* what;
    dds_entity_t reader;
  } sources[2] = {
      {"writer",
       checked(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL), "builtin")},
      {"reader",
       checked(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, NULL, NULL), "builtin")}};
  int seen = 0;
  for (const dds_time_t until = dds_time() + LIMIT; dds_time() < until; dds_sleepfor(PAUSE)) {
    for (int i = 0; i < 2; i++) {
      void* sample[1] = {NULL};
      dds_sample_info_t info;
      while (dds_take(sources[i].reader, sample, &info, 1, 1) > 0) {
        if (info.valid_data && ++seen) print_endpoint(sources[i].what, sample[0]);
        dds_return_loan(sources[i].reader, sample, 1);
      }
    }
    if (seen >= count) return 0;
  }
  fprintf(stderr, "cyclone_peer: only %d endpoints\n", seen);
  return 1;
}

int main(int argc, char** argv) {
  int status = 2;
  if (argc >= 4) join(atoi(argv[1]), argv[2]);
  if (argc == 5 && strcmp(argv[3], "listen") == 0)
    status = listen_to(atoi(argv[4]));
  else if (argc == 5 && strcmp(argv[3], "qos") == 0)
    status = list_qos(atoi(argv[4]));
  else if (argc == 7 && strcmp(argv[3], "say") == 0)
    status = say(argv[4], (unsigned)atoi(argv[5]), atoi(argv[6]));
  else if (argc == 7 && strcmp(argv[3], "order") == 0)
    status = order(argv[4], argv[5], argv[6]);
  else
    fprintf(stderr,
            "usage: cyclone_peer DOMAIN CELL listen COUNT | qos COUNT | say STATION CODE SECONDS |\n"
            "                                order Start|Stop|Msg STATION BODY\n");
  if (argc >= 4) dds_delete(participant);
  return status;
}
