// SPDX-License-Identifier: Apache-2.0
import "./lab.css";
import { Lab } from "./lab";
import { initTheme } from "./theme";

initTheme();
void new Lab().start();
