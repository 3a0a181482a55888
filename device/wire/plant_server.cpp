#include "device/wire/plant_server.h"

#include <algorithm>
#include <cmath>

#include "device/scales.h"

namespace handloop::device::wire {
namespace {

constexpr std::int64_t kIdlePoll_us = 20'000;

}  // namespace

PlantServer::PlantServer(ServerOptions options, PlantFactory factory)
    : options_(std::move(options)), factory_(std::move(factory)), socket_(Socket::bound(options_.listen)) {}

PlantServer::~PlantServer() {
  end_session();
}

void PlantServer::serve(const std::atomic<bool>& stop) {
  std::array<std::byte, kMaxPacketBytes + 1> bytes;
  while (!stop.load(std::memory_order_relaxed)) {
    std::int64_t wait_us = kIdlePoll_us;
    const bool real_time = plant_ && !lock_step_;
    if (real_time) {
      const std::int64_t due_ns = schedule_.start_ns + schedule_.next_cycle * schedule_.period_ns;
      wait_us = std::max<std::int64_t>((due_ns - clock_.now_ns()) / 1000, 0);
    }
    Address from;
    if (const auto size = socket_.receive(bytes, from, wait_us)) {
      take(std::span(bytes).first(std::min(*size, bytes.size())), from);
    }
    if (!plant_) continue;
    const std::int64_t now_ns = clock_.now_ns();
    if (!lock_step_ && now_ns >= schedule_.start_ns + schedule_.next_cycle * schedule_.period_ns) {
      account_wake_up(schedule_, now_ns);
      run_sample();
    }
    if (static_cast<double>(now_ns - last_heard_ns_) * 1e-9 > options_.idle_s) end_session();
  }
  end_session();
}

void PlantServer::send(const Packet& packet, const Address& to, bool tagged) {
  std::array<std::byte, kMaxPacketBytes> bytes;
  const std::size_t size = encode(packet, tagged && options_.key ? &*options_.key : nullptr, bytes);
  ++counters_.sent;
  socket_.send(std::span(bytes).first(size), to);
}

void PlantServer::refuse(Refusal refusal, std::uint64_t nonce, const Address& to, bool tagged) {
  Packet packet;
  packet.type = PacketType::refuse;
  packet.nonce = nonce;
  packet.refusal = refusal;
  send(packet, to, tagged);
}

void PlantServer::take(std::span<const std::byte> datagram, const Address& from) {
  ++counters_.received;
  Packet packet;
  const auto verdict = decode(datagram, options_.key ? &*options_.key : nullptr, packet);
  ++counters_.by_verdict[static_cast<std::size_t>(verdict)];
  if (verdict == Verdict::not_authenticated && packet.type == PacketType::open &&
      ((packet.flags & kAuthenticated) == 0)) {
    // Only whoever came without any key is told: a wrong key gets silence.
    Packet plain;
    if (decode(datagram, nullptr, plain) == Verdict::good) {
      refuse(Refusal::authentication, plain.nonce, from, false);
    }
    return;
  }
  if (verdict != Verdict::good) return;
  if (packet.type == PacketType::open) return open(packet, from);
  if (!plant_ || !(from == peer_) || packet.session != session_) {
    ++counters_.wrong_session;
    return;
  }
  if (packet.type == PacketType::command) {
    command(packet);
  } else if (packet.type == PacketType::close) {
    end_session();
  } else {
    ++counters_.wrong_session;
  }
}

void PlantServer::open(const Packet& packet, const Address& from) {
  if (plant_ && from == peer_ && packet.nonce == nonce_) {
    // Our answer was lost: the same again, as long as nothing has happened since.
    ++counters_.doubled;
    if (!commanded_) accept();
    return;
  }
  if (plant_) return refuse(Refusal::busy, packet.nonce, from, true);
  if (packet.scenario_hash != options_.scenario_hash) return refuse(Refusal::scenario, packet.nonce, from, true);
  try {
    auto plant = factory_(packet.seed);
    plant->start();
    reading_ = plant->read();
    plant_ = std::move(plant);
  } catch (...) {
    return refuse(Refusal::plant, packet.nonce, from, true);
  }
  ++sessions_;
  peer_ = from;
  nonce_ = packet.nonce;
  session_ = random_number();
  lock_step_ = (packet.flags & kLockStep) != 0;
  held_ = {};
  held_.dac_codes.fill(zero_code(plant_->description()));
  commanded_ = silenced_ = false;
  last_command_ = 0;
  silent_samples_ = 0;
  last_heard_ns_ = clock_.now_ns();
  const auto period_ns = std::llround(plant_->description().sample_time_s * 1e9);
  schedule_ = begin_schedule(last_heard_ns_ + period_ns, period_ns);
  accept();
}

void PlantServer::accept() {
  Packet packet;
  packet.type = PacketType::accept;
  packet.session = session_;
  packet.nonce = nonce_;
  packet.scenario_hash = options_.scenario_hash;
  packet.reading = reading_;
  send(packet, peer_);
}

void PlantServer::command(const Packet& packet) {
  last_heard_ns_ = clock_.now_ns();
  if (packet.sequence > reading_.sample) {
    ++counters_.ahead;
    return;
  }
  if (lock_step_) {
    if (packet.sequence == reading_.sample) {
      held_ = packet.command;
      commanded_ = true;
      run_sample();
    } else if (packet.sequence + 1 == reading_.sample) {
      ++counters_.doubled;
      send_reading();
    } else {
      ++counters_.reordered;
    }
    return;
  }
  if (commanded_ && packet.sequence <= last_command_) {
    ++(packet.sequence == last_command_ ? counters_.doubled : counters_.reordered);
    return;
  }
  if (commanded_) counters_.lost += packet.sequence - last_command_ - 1;
  held_ = packet.command;
  last_command_ = packet.sequence;
  commanded_ = true;
  silent_samples_ = 0;
  silenced_ = false;
}

void PlantServer::run_sample() {
  if (!lock_step_ && ++silent_samples_ > options_.silence_samples && !silenced_) {
    silenced_ = true;
    ++counters_.silences;
    held_.dac_codes.fill(zero_code(plant_->description()));
  }
  try {
    plant_->write(held_);
    reading_ = plant_->read();
  } catch (...) {
    end_session();
    return;
  }
  send_reading();
}

void PlantServer::send_reading() {
  Packet packet;
  packet.type = PacketType::reading;
  packet.session = session_;
  packet.sequence = reading_.sample;
  packet.reading = reading_;
  send(packet, peer_);
}

void PlantServer::end_session() noexcept {
  if (!plant_) return;
  try {
    plant_->stop();
  } catch (...) {
    // The plant is dropped all the same.
  }
  plant_.reset();
  session_ = 0;
}

}  // namespace handloop::device::wire
