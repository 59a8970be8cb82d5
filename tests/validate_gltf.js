// Exit 0 when the Khronos validator has no error and no warning about a .glb.
// node validate_gltf.js FOLDER_OF_THE_VALIDATOR FILE.glb
const fs = require("fs");
const [, , folder, file] = process.argv;
const validator = require(folder);
validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 100 }).then((report) => {
  const bad = report.issues.messages.filter((m) => m.severity <= 1);
  for (const m of bad.slice(0, 3)) console.error(`${m.code} ${m.pointer}: ${m.message}`);
  process.exit(bad.length ? 1 : 0);
});
