#include "studies/margins_cases.h"

#include <gtest/gtest.h>

#include <string>

#include "control/margins.h"
#include "models/errors.h"

namespace handloop::studies {
namespace {

const std::string kHeader = "id,axis,M,k1,k2,b1,b2,K,B\n";
const std::string kNominal = "0.2179,379.5,78.75,1.839,4.645";

std::string message_of(const std::string& csv) {
  try {
    margins_of_cases(csv, "cases.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MarginsOfCases, KeepsTheOrderForAnyNumberOfThreads) {
  std::string csv = kHeader;
  for (int i = 0; i < 20000; ++i)
    csv += "r" + std::to_string(i) + ",x," + kNominal + "," + std::to_string(10 + i % 977) + ",1\n";
  const std::string one = margins_of_cases(csv, "cases.csv", 1), four = margins_of_cases(csv, "cases.csv", 4);
  EXPECT_EQ(one, four);
  std::size_t line = 0, at = 0;
  while ((at = one.find('\n', at)) != std::string::npos) {
    ++at;
    if (at >= one.size()) break;
    ASSERT_EQ(one.compare(at, 2 + std::to_string(line).size(), "r" + std::to_string(line) + ","), 0) << line;
    ++line;
  }
  EXPECT_EQ(line, 20000U);
}

TEST(MarginsOfCases, WritesWhatTheContractSays) {
  const std::string out = margins_of_cases(
      kHeader + "a,X," + kNominal + ",400,1\nb,X," + kNominal + ",9000,0\nc,X," + kNominal + ",0,0\n", "cases.csv");
  EXPECT_EQ(out.substr(0, out.find('\n')), "id,stable,rho,gm_up,gm_down,pm_deg,dm_s,sm,disk_alpha");
  EXPECT_NE(out.find("\na,1,0."), std::string::npos) << out;
  const auto b = out.find("\nb,0,1.");
  ASSERT_NE(b, std::string::npos) << out;
  EXPECT_EQ(out.substr(out.find('\n', b + 1) - 6, 6), ",,,,,,") << out;
  EXPECT_NE(out.find("\nc,1,"), std::string::npos);
  EXPECT_NE(out.find(",inf,0,inf,inf,1,2\n"), std::string::npos) << out;
}

TEST(MarginsOfCases, TakesColumnsInAnyOrderAndLoopsOfTheirOwn) {
  const std::string csv =
      "note,B,K,b2,b1,k2,k1,M,axis,id,m,b,T,delay_samples,cutoff_Hz\r\n\"hello\",1,400,4.645,1.839,78.75,379.5,0.2179,"
      "x,7,0.1,0.2,0.0005,2,inf\r\n";
  const std::string out = margins_of_cases(csv, "cases.csv");
  const control::Margins m = control::evaluate({{0.1, 0.2, models::ArmParameters{0.2179, 379.5, 78.75, 1.839, 4.645}},
                                                {0.0005, 2, std::numeric_limits<double>::infinity()},
                                                {400, 1}});
  const std::string row = out.substr(out.find('\n') + 1);
  EXPECT_EQ(row.substr(0, 4), "7,1,");
  EXPECT_EQ(std::stod(row.substr(4)), m.rho);
}

TEST(MarginsOfCases, NamesFileLineAndColumnOfWhatIsWrong) {
  EXPECT_NE(message_of("id,K\n1,2\n").find("cases.csv, line 1: no column 'axis'"), std::string::npos);
  EXPECT_NE(message_of(kHeader + "1,x," + kNominal + ",400,1\n2,x," + kNominal + ",4o0,1\n")
                .find("line 3: column 'K': '4o0'"),
            std::string::npos);
  EXPECT_NE(message_of(kHeader + "1,q," + kNominal + ",400,1\n").find("'q' is no axis"), std::string::npos);
  EXPECT_NE(message_of(kHeader + "1,x," + kNominal + ",400\n").find("8 fields where the header has 9"),
            std::string::npos);
  EXPECT_NE(message_of(kHeader + "1,x,-0.1,379.5,78.75,1.839,4.645,400,1\n").find("mass_kg"), std::string::npos);
  EXPECT_NE(message_of(kHeader + "1,x," + kNominal + ",nan,1\n").find("stiffness"), std::string::npos);
}

TEST(MarginsOfCases, OfNoRowsIsAHeader) {
  EXPECT_EQ(margins_of_cases(kHeader, "cases.csv"), "id,stable,rho,gm_up,gm_down,pm_deg,dm_s,sm,disk_alpha\n");
}

}  // namespace
}  // namespace handloop::studies
