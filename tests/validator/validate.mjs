// Khronos's validator over glTF files: `node validate.mjs FILE...`, with gltf-validator in a node_modules folder of the
// working directory. Names every error and warning; exits with 1 if there is any.
import { readFileSync, existsSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const validator = createRequire(path.join(process.cwd(), "/"))("gltf-validator");
let found = 0;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 20,
    externalResourceFunction: async (uri) => {
      const beside = path.join(path.dirname(file), decodeURIComponent(uri));
      if (!existsSync(beside)) throw new Error("missing " + uri);
      return new Uint8Array(readFileSync(beside));
    },
  });
  const severe = report.issues.messages.filter((message) => message.severity < 2);
  for (const message of severe) console.log(`${path.basename(file)}: ${message.code} ${message.pointer ?? ""} ${message.message}`);
  found += report.issues.numErrors + report.issues.numWarnings;
  console.log(`${path.basename(file)}: ${report.issues.numErrors} errors, ${report.issues.numWarnings} warnings`);
}
process.exit(found > 0 ? 1 : 0);
