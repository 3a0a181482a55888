#include "tests/device/comedi/stand_in.h"

#include <comedilib.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>

using handloop::comedi_stand_in::registers;

struct comedi_t_struct {
  int board;
};

namespace handloop::comedi_stand_in {

Registers& registers() {
  static Registers* shared = [] {
    void* memory = ::mmap(nullptr, sizeof(Registers), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return new (memory) Registers{};
  }();
  return *shared;
}

void power_up() {
  Registers& r = registers();
  r.~Registers();
  new (&r) Registers{};
  for (auto& code : r.dac) code = 3000;
  for (auto& code : r.adc) code = 32768;
}

}  // namespace handloop::comedi_stand_in

namespace {

thread_local int error_number = 0;
int fail(int number = EINVAL) {
  error_number = number;
  return -1;
}

constexpr comedi_range kDdaRanges[] = {{-10, 10, UNIT_volt}, {-5, 5, UNIT_volt}, {-2.5, 2.5, UNIT_volt},
                                       {0, 10, UNIT_volt},   {0, 5, UNIT_volt},  {0, 2.5, UNIT_volt}};
constexpr comedi_range kAdcRanges[] = {
    {-10, 10, UNIT_volt},   {-5, 5, UNIT_volt},     {-2, 2, UNIT_volt},  {-1, 1, UNIT_volt}, {-0.5, 0.5, UNIT_volt},
    {-0.2, 0.2, UNIT_volt}, {-0.1, 0.1, UNIT_volt}, {0, 10, UNIT_volt},  {0, 5, UNIT_volt},  {0, 2, UNIT_volt},
    {0, 1, UNIT_volt},      {0, 0.5, UNIT_volt},    {0, 0.2, UNIT_volt}, {0, 0.1, UNIT_volt}};

bool is_counter(const comedi_t* it, unsigned sub) {
  return it->board == 0 && sub >= 2 && sub <= 9;
}
bool is_ai(const comedi_t* it, unsigned sub) {
  return it->board == 1 && sub == 0;
}
bool is_ao(const comedi_t* it, unsigned sub) {
  return it->board == 2 && sub == 0;
}

int write_dac(unsigned spec, lsampl_t data) {
  auto& r = registers();
  if (CR_CHAN(spec) >= 8 || CR_RANGE(spec) >= 6 || data > 4095) return fail();
  if (r.dac_write_fails) return fail(EIO);
  r.dac[CR_CHAN(spec)] = data;
  r.dac_specs[CR_CHAN(spec)] = spec;
  ++r.writes;
  return 1;
}

int read_adc(unsigned spec, lsampl_t* data) {
  auto& r = registers();
  if (CR_CHAN(spec) >= 64 || CR_RANGE(spec) >= 14) return fail();
  if (r.adc_read_fails) return fail(ETIMEDOUT);
  r.adc_specs[CR_CHAN(spec)] = spec;
  *data = r.adc[CR_CHAN(spec)];
  return 1;
}

}  // namespace

extern "C" {

int comedi_loglevel(int) {
  return 0;
}
int comedi_errno(void) {
  return error_number;
}
const char* comedi_strerror(int number) {
  return std::strerror(number);
}

comedi_t* comedi_open(const char* path) {
  constexpr std::string_view kPrefix = "/dev/comedi";
  const std::string_view name = path;
  const int board = name.starts_with(kPrefix) && name.size() == kPrefix.size() + 1 ? name.back() - '0' : -1;
  if (board < 0 || board > 2 || registers().no_board[board]) {
    error_number = ENOENT;
    return nullptr;
  }
  return new comedi_t{board};
}
int comedi_close(comedi_t* it) {
  delete it;
  return 0;
}
int comedi_get_n_subdevices(comedi_t* it) {
  return it->board == 0 ? 10 : it->board == 1 ? 10 : 3;
}
const char* comedi_get_board_name(comedi_t* it) {
  constexpr const char* kNames[] = {"PCI-6602", "pci-6031e", "pci-dda08/12"};
  return kNames[it->board];
}
int comedi_get_subdevice_type(comedi_t* it, unsigned sub) {
  if (it->board == 0) {
    if (sub == 0) return COMEDI_SUBD_UNUSED;
    return sub == 1 || registers().counters_missing ? COMEDI_SUBD_DIO : COMEDI_SUBD_COUNTER;
  }
  if (it->board == 1) return sub == 0 ? COMEDI_SUBD_AI : sub == 1 ? COMEDI_SUBD_AO : COMEDI_SUBD_UNUSED;
  return sub == 0 ? COMEDI_SUBD_AO : COMEDI_SUBD_DIO;
}
int comedi_get_n_channels(comedi_t* it, unsigned sub) {
  return is_counter(it, sub) ? 3 : is_ai(it, sub) ? 64 : is_ao(it, sub) ? 8 : 24;
}
lsampl_t comedi_get_maxdata(comedi_t* it, unsigned sub, unsigned) {
  return is_counter(it, sub) ? 0xffffffffu : is_ai(it, sub) ? 65535u : is_ao(it, sub) ? 4095u : 1u;
}
int comedi_get_n_ranges(comedi_t* it, unsigned sub, unsigned) {
  return is_ai(it, sub) ? 14 : is_ao(it, sub) ? 6 : 1;
}
comedi_range* comedi_get_range(comedi_t* it, unsigned sub, unsigned, unsigned range) {
  if (is_ai(it, sub) && range < 14) return const_cast<comedi_range*>(&kAdcRanges[range]);
  if (is_ao(it, sub) && range < 6) return const_cast<comedi_range*>(&kDdaRanges[range]);
  return nullptr;
}

int comedi_data_write(comedi_t* it, unsigned sub, unsigned chan, unsigned range, unsigned aref, lsampl_t data) {
  auto& r = registers();
  if (is_counter(it, sub)) {
    if (chan > 2) return fail();
    if (chan == 0) r.counters[sub] = data;
    return 1;
  }
  if (!is_ao(it, sub)) return fail();
  if (r.dac_writes_failing.load() > 0) {
    --r.dac_writes_failing;
    return fail(EBUSY);
  }
  return write_dac(CR_PACK(chan, range, aref), data);
}
int comedi_data_read(comedi_t* it, unsigned sub, unsigned chan, unsigned range, unsigned aref, lsampl_t* data) {
  auto& r = registers();
  if (is_ai(it, sub)) return read_adc(CR_PACK(chan, range, aref), data);
  if (!is_counter(it, sub) || chan > 2) return fail();
  if (r.counter_read_fails) return fail(EIO);
  *data = r.counters[sub];
  return 1;
}
int comedi_do_insnlist(comedi_t* it, comedi_insnlist* list) {
  for (unsigned i = 0; i < list->n_insns; ++i) {
    if (registers().partial_list && i == 1) return 1;
    const comedi_insn& insn = list->insns[i];
    int done = -1;
    if (insn.insn == INSN_WRITE && is_ao(it, insn.subdev)) done = write_dac(insn.chanspec, *insn.data);
    if (insn.insn == INSN_READ && is_ai(it, insn.subdev)) done = read_adc(insn.chanspec, insn.data);
    if (done < 0) return i == 0 ? fail() : static_cast<int>(i);
  }
  return static_cast<int>(list->n_insns);
}

int comedi_reset(comedi_t* it, unsigned sub) {
  if (!is_counter(it, sub) || registers().reset_fails) return fail();
  registers().armed[sub] = false;
  registers().modes[sub] = 0;
  return 0;
}
int comedi_set_gate_source(comedi_t* it, unsigned sub, unsigned, unsigned gate, unsigned source) {
  return is_counter(it, sub) && gate <= 1 && source == NI_GPCT_DISABLED_GATE_SELECT ? 0 : fail();
}
int comedi_set_other_source(comedi_t*, unsigned, unsigned, unsigned, unsigned) {
  return fail();
}  // the 660x's own way
int comedi_set_counter_mode(comedi_t* it, unsigned sub, unsigned, unsigned mode) {
  if (!is_counter(it, sub)) return fail();
  registers().modes[sub] = mode;
  return 0;
}
int comedi_arm(comedi_t* it, unsigned sub, unsigned source) {
  if (!is_counter(it, sub) || source != NI_GPCT_ARM_IMMEDIATE || registers().arm_fails) return fail();
  registers().armed[sub] = true;
  return 0;
}

}  // extern "C"
