#include "study/sweep_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;

class SweepRefusals : public testing::SweepFolder {};

TEST_F(SweepRefusals, NonsenseInAFile) {
  const std::string lhs = "method = \"lhs\"\nsamples = 4\n[vary]\n";
  const std::string compare = "[compare]\ncase = [\"plain\", \"noisy\"]\n";
  const std::string goal = compare + "goal.y_1 = \"min\"\n";
  const std::string many = " = \"lin(0,1,10000)\"\n";
  for (const auto& [text, line] : Refusals{
           {"[objective]\ny_1 = { goal = \"min\" }\n",
            "bad.toml:2: objective: is of a tuning: breakwater tune"},
           {"sample = 3\n", "bad.toml:2: sample: unknown key (did you mean samples?)"},
           {"[vary]\n\"x.frist\" = [1]\n",
            "bad.toml:3: vary.x.frist: unknown key (did you mean x.first?)"},
           {"[vary]\n\"x.first\" = [1, \"two\"]\n",
            "bad.toml:3: vary.x.first: must be a number, is \"two\""},
           {"[vary]\n\"x.first=2\" = [1, 2]\n", "bad.toml:3: vary.x.first=2: is no key"},
           {"[set]\n\"x.first = 2\" = 1\n", "bad.toml:3: set.x.first = 2: is no key"},
           {"[set]\n\"\" = 1\n", "bad.toml:3: set.: is no key"},
           {"config = \"absent.toml\"\n", "bad.toml:2: config: there is no file absent.toml"},
           {"[set]\n\"x.frist\" = 1\n",
            "bad.toml:3: set.x.frist: unknown key (did you mean x.first?)"},
           {"[set]\nx.first = \"two\"\n", "bad.toml:3: set.x.first: must be a number, is \"two\""},
           {"seeds = [1, 2]\n[set]\nrun.seed = 3\n",
            "bad.toml:4: set.run.seed: stands beside seeds: leave one of them out"},
           {"[vary]\n\"y.noise\" = [1, -1]\n",
            "bad.toml:3: vary.y.noise: must be 0 or more, is -1"},
           {"[vary]\n\"x.first\" = []\n", "bad.toml:3: vary.x.first: has no values"},
           {"[vary]\n\"x.first\" = \"lin(2,1,4)\"\n",
            "bad.toml:3: vary.x.first: \"lin(2,1,4)\" must rise: 2 is above 1"},
           {"[vary]\n\"x.first\" = \"log(0,1,4)\"\n",
            "bad.toml:3: vary.x.first: \"log(0,1,4)\" must be positive: it is logarithmic"},
           {lhs + "\"x.first\" = { uniform = [1, 0] }\n",
            "bad.toml:5: vary.x.first: the range [1, 0] is upside down"},
           {lhs + "\"x.first\" = { log_uniform = [0, 1] }\n",
            "bad.toml:5: vary.x.first: a logarithmic range must be positive, and begins at 0"},
           {lhs + "\"x.first\" = { unifrom = [0, 1] }\n",
            "bad.toml:5: vary.x.first: there is no distribution unifrom (did you mean uniform?)"},
           {"[vary]\n\"x.first\" = { uniform = [0, 1] }\n",
            "bad.toml:3: vary.x.first: a distribution needs a method that draws: random, lhs, "
            "sobol or saltelli"},
           {"[vary]\n\"run.seed\" = [1, 2]\n", "bad.toml:3: vary.run.seed: say seeds instead"},
           {"[compare]\n\"run.seed\" = [1, 2]\n",
            "bad.toml:3: compare.run.seed: say seeds instead"},
           {"[vary]\n\"x.first\" = [1, 2, 1]\n",
            "bad.toml:3: vary.x.first: a value is there twice"},
           {"method = \"list\"\n[vary]\n\"x.first\" = [1, 2]\n\"x.second\" = [1]\n",
            "bad.toml:5: vary.x.second: has 1 values, and x.first has 2: a list needs as many of "
            "each"},
           {"method = \"sobol\"\n[vary]\n\"x.first\" = [1, 2]\n",
            "bad.toml:2: method: sobol needs samples"},
           {"seeds = { first = 1, cuont = 3 }\n",
            "bad.toml:2: seeds.cuont: unknown key (did you mean count?)"},
           {"seeds = [1, 1]\n", "bad.toml:2: seeds: one is there twice"},
           {"[compare]\ncase = [\"plain\", \"nosy\"]\n",
            "bad.toml:3: compare.case: PROJECT/tests/study/ishigami/ishigami.toml has no case "
            "\"nosy\" (did you mean noisy?)"},
           {compare + "baseline = \"other\"\n",
            "bad.toml:4: compare.baseline: \"other\" is not among what is compared: plain; noisy"},
           {compare + "goal = { y_1 = \"mni\" }\n",
            "bad.toml:4: compare.goal.y_1: must be one of min, max, is \"mni\" (did you mean "
            "min?)"},
           {compare + "goal = \"min\"\n", "bad.toml:4: compare.goal: must be a table"},
           {compare + "basline = \"plain\"\n",
            "bad.toml:4: compare.basline: unknown key (did you mean baseline?)"},
           {compare + "baseline = \"\"\n",
            "bad.toml:4: compare.baseline: must be a text, is empty"},
           {compare + "[require]\ny_1.max = 1\n",
            "bad.toml:4: require: needs compare.goal: what candidates are ranked by"},
           {goal + "[require]\nshare = 0.9\n", "bad.toml:5: require: has no bound of a metric"},
           {goal + "[require]\ny_1 = {}\n",
            "bad.toml:6: require.y_1: has no bound: say min, max or both"},
           {goal + "[require]\ny_1 = 3\n", "bad.toml:6: require.y_1: must be a table"},
           {goal + "[require]\ny_1 = { min = 2, max = 1 }\n",
            "bad.toml:6: require.y_1: min 2 is above max 1"},
           {goal + "[require]\ny_1 = { mx = 1 }\n",
            "bad.toml:6: require.y_1.mx: unknown key (did you mean max?)"},
           {goal + "[require]\ny_1 = { max = \"1\" }\n",
            "bad.toml:6: require.y_1.max: must be a number"},
           {goal + "[require]\nshare = 0\ny_1.max = 1\n",
            "bad.toml:6: require.share: must be above 0 and at most 1, is 0"},
           {goal + "[require]\nconfidence = 1\ny_1.max = 1\n",
            "bad.toml:6: require.confidence: must be from 0.5 to 0.9999, is 1"},
           {goal + "[require]\ny_2.max = 1\n",
            "bad.toml:6: require.y_2: there is no such metric (did you mean y_1?)"},
           {goal + "[require]\nunheard_of.max = 1\n",
            "bad.toml:6: require.unheard_of: there is no such metric (there are y_1, "
            "positive_x_second_1)"},
           {goal + "[require]\ny_1 = { maximum = 1 }\n",
            "bad.toml:6: require.y_1.maximum: unknown key (there are min, max)"},
           {"[slurm]\naccount = \"\"\n", "bad.toml:3: slurm.account: must be a text, is empty"},
           {"[slurm]\nenvironment = [\"B;touch P=1\"]\n",
            "bad.toml:3: slurm.environment: B;touch P=1: must be NAME=VALUE; a name has letters, "
            "digits and _"},
           {"[slurm]\nenvironment = [\"SLURM_ARRAY_TASK_ID=1\"]\n",
            "bad.toml:3: slurm.environment: SLURM_ARRAY_TASK_ID=1: is a variable that Slurm sets "
            "for "
            "each task"},
           {"[slurm]\noptions = [\"--mem=4G\", \"--qos=x --arr=0-9\"]\n",
            "bad.toml:3: slurm.options: --arr=0-9: is an option that the job script sets: leave it "
            "out"},
           {"[slurm]\noptions = [\"-a0-9\"]\n",
            "bad.toml:3: slurm.options: -a0-9: is an option that the job script sets: leave it "
            "out"},
           {compare + "metrics = []\n", "bad.toml:4: compare.metrics: is empty"},
           {"[vary]\n\"x.first\"" + many + "\"x.second\"" + many + "\"x.third\"" + many,
            "vary: 1e+12 points are more than 10000000: 1e+12 samples, 1 seeds, 1 candidates"}}) {
    write("bad.toml", "scenario = \"ishigami\"\n" + text);
    SCOPED_TRACE(text);
    expect_refused("ishigami_lab sweep bad.toml --out s", line);
  }
  write("bad.toml", "scenario = \"ishigam\"\n");
  expect_refused("ishigami_lab sweep bad.toml --out s",
                 "bad.toml:1: scenario: there is no scenario \"ishigam\" (did you mean ishigami?)");
}

TEST_F(SweepRefusals, NonsenseInTheCommand) {
  write("noisy.toml", "scenario = \"ishigami\"\ncase = \"noisy\"\n");
  expect_refusals(
      "ishigami_lab sweep ",
      {{"noisy.toml --case ''", "sweep: --case: must not be empty (see --help)"},
       {"noisy.toml --case , --out X", "--case: ,: a name is missing"},
       {"ishigami --metrics y_1,,y_2", "--metrics: y_1,,y_2: a name is missing"},
       {"ishigami --sampling-seed 18446744073709551615",
        "--sampling-seed: 18446744073709551615: must be at most 9223372036854775807"},
       {"ishigami --sampling-seed two", "--sampling-seed: two: must be a number"},
       {"noisy.toml --replay ''", "sweep: --replay: must not be empty (see --help)"},
       {"ishigami --goal y_1=min --require y_1=0.6",
        "--require: y_1: 0.6: must be MIN..MAX, MIN.. or ..MAX"},
       {"ishigami --goal y_1=min --require y_1=a..2",
        "--require: y_1: a..2: must be MIN..MAX, MIN.. or ..MAX"},
       {"ishigami --goal y_1=min --require y_1=2..1", "--require: y_1: min 2 is above max 1"},
       {"ishigami --require y_1=1..2",
        "--require: needs compare.goal: what candidates are ranked by"},
       {"ishigami --goal y_1=least", "--goal: y_1: must be one of min, max, is \"least\""},
       {"ishigami --vary x.first", "--vary: x.first: must be of the form KEY=VALUE"},
       {"ishigami --vary x.first=1,,2", "--vary: x.first: 1,,2: a value is missing"},
       {"ishigami --vary x.first=1 --vary x.first=2", "--vary: x.first: is given twice"},
       {"ishigami --case nosy",
        "--case: PROJECT/tests/study/ishigami/ishigami.toml has no case \"nosy\" (did you mean "
        "noisy?)"},
       {"ishigami --set x.frist=2", "--set: x.frist: unknown key (did you mean x.first?)"},
       {"ishigami --seeds 1..2 --set run.seed=2",
        "--set: run.seed: stands beside seeds: leave one of them out"},
       {"ishigami --vary x.first=1 --set x.first=2", "--vary: x.first: is set and varied"},
       {"ishigami --vary x.first=unifrom(0,1)",
        "--vary: x.first: unifrom(0,1): there is no unifrom(): there are uniform, "
        "log_uniform, normal, lin, log (did you mean uniform?)"},
       {"ishigami --seeds 5..1", "--seeds: 5..1: must be 1..20 or 1,4,7"},
       {"ishigami --seeds 1..100000000", "--seeds: 1..100000000: must be at most 1000000 seeds"},
       {"ishigam", "there is no scenario \"ishigam\" (did you mean ishigami?)"},
       {"nothing.toml", "nothing.toml: there is no such file or folder"}});
}

TEST_F(SweepRefusals, WarnsOfIneffectiveKeys) {
  const auto said = [&](const std::string& words) {
    const ProgramResult result = ran(words + " --out s");
    fs::remove_all(folder_ / "s");
    return result;
  };
  for (const auto& [words, warning] : Refusals{
           {"--method sobol --vary x.first=uniform(0,1) --samples 100",
            "samples: Sobol' points are even for a power of two: 64 or 128"},
           {"--method sobol --vary x.first=uniform(0,1) --samples 64", ""},
           {"--seeds 1..3", "seeds: the 3 of each sample gave the same run: no noise reaches them"},
           {"--seeds 1..3 --dry-run", "seeds: 1 and 2 give the same runs: no noise reaches them"},
           {"--seeds 1..3 --case noisy", ""},
           {"--vary x.second=1,2", ""},
           {"--vary x.second=-1,1",
            "positive_x_second_1 is missing: in 1 of 2 complete runs of plain"},
           {"--case 'plain, noisy' --set y.noise=0 --vary x.second=1,2 --dry-run",
            "Too few blocks: with 2 blocks p cannot be below 0.5, and a verdict needs at least 6"},
           {"--case plain,noisy --goal y_1=min --vary 'x.second=lin(1,6,6)' --dry-run",
            "seeds: 2 gives another run of noisy than 1: one seed is one draw of the noise, and "
            "more of them show what depends on it"},
           {"--case plain --set x.third=2 --goal y_1=min --vary x.second=1,2 --dry-run", ""},
           {"--case plain,noisy --goal y_1=min --vary 'x.second=lin(1,6,6)'",
            "seeds: one, so any noise is one draw of it (--dry-run looks for noise)"},
           {"--duration 0.5 --dry-run", ""}}) {  // their runs are shorter
    const ProgramResult result = said("ishigami_lab sweep ishigami " + words);
    const std::string all = result.err + result.out;
    EXPECT_TRUE(warning.empty() ? lacks(all, "warning", "same run") : has(all, warning)) << words;
    EXPECT_EQ(said("ishigami_lab sweep ishigami --quiet " + words).err,
              warning.empty() ? "" : "sweep: warning: " + warning + "\n")
        << words;
  }
  // A key without effect for the chosen estimator, and one that only another candidate uses.
  const auto motor = [&](const std::string& cases) {
    return said("breakwater sweep motor_estimation --case " + cases +
                " --vary observer.poles_rad_s=[-10,-20,-30],[-11,-20,-30] --duration 0.01")
        .err;
  };
  EXPECT_TRUE(has(motor("stf"), "sweep: warning: --vary: observer."));
  EXPECT_TRUE(lacks(motor("stf,idob"), "warning"));
}

}  // namespace
}  // namespace breakwater
