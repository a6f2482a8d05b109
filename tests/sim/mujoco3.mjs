// MuJoCo 3 (npm package @mujoco/mujoco): accelerations and forces of the actuators on the joints of a model at given states.
// node mujoco3.mjs MODEL STATES: each line of STATES has qpos, qvel, act and ctrl. Contacts are off.
import fs from 'node:fs';

const load = (await import(process.env.BREAKWATER_MUJOCO3 ?? '@mujoco/mujoco')).default;
const mujoco = await load();
const [model_file, states_file] = process.argv.slice(2);
const model = mujoco.MjModel.from_xml_string(fs.readFileSync(model_file, 'utf8'));
const data = new mujoco.MjData(model);
model.opt.disableflags |= 1 << 4;
model.opt.tolerance = 0;
model.opt.iterations = 200;
for (const line of fs.readFileSync(states_file, 'utf8').trim().split('\n')) {
  const numbers = line.split(' ').map(Number);
  for (const [array, size] of [['qpos', model.nq], ['qvel', model.nv], ['act', model.na], ['ctrl', model.nu]]) {
    if (size > 0) data[array].set(numbers.splice(0, size));
  }
  mujoco.mj_forward(model, data);
  console.log([...data.qacc, ...data.qfrc_actuator].join(' '));
}
