// SPDX-License-Identifier: Apache-2.0
// The tasks of the lessons. A solution is the built-in program with edits. A task is done if the user's program renders the
// same image as the solution, with the stated parameters.
import type { ParameterValue } from "./protocol";

export interface LessonTask {
  id: string; // unique, for the stored progress
  text: string; // Markdown
  hint: string; // Markdown
  // Each replaces the only occurrence of a text in the main file.
  edits: [string, string][];
  samples?: number; // samples or frames that are compared; 1 by default
  parameters?: Record<string, ParameterValue>;
}

// By the name of the lesson, such as "05_shadow".
export const kLessonTasks: Readonly<Record<string, readonly LessonTask[]>> = {};
